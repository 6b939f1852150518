#pragma once
/// Lists of infeasible pairs without duplicates.

#include <algorithm>
#include <vector>

#include "weft/report.h"

namespace weft::engine {

inline void add_once(const InfeasiblePair& pair, std::vector<InfeasiblePair>& pairs) {
  if (std::find(pairs.begin(), pairs.end(), pair) == pairs.end()) pairs.push_back(pair);
}

}  // namespace weft::engine
