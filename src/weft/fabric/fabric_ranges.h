#pragma once
/// Ranges of a fabric's numbers that have two limits.

#include <string_view>

namespace weft::engine {

struct FabricRange {
  double min, max;
  std::string_view words;  // for messages

  constexpr bool contains(double number) const { return number >= min && number <= max; }
};

constexpr FabricRange kDampingRange{0, 10, "from 0 to 10 s (a time constant, not N·s/m)"};
constexpr FabricRange kThicknessRange{1e-6, 0.05, "from 1e-6 to 0.05 m"};
constexpr FabricRange kFrictionRange{0, 10, "from 0 to 10"};
constexpr FabricRange kStrainLimitRange{0, 10, "from 0 (none) to 10"};

}  // namespace weft::engine
