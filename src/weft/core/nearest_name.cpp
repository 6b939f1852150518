#include "weft/core/nearest_name.h"

#include <algorithm>
#include <cstdlib>

namespace weft::engine {

int edit_distance(std::string_view a, std::string_view b, int limit) {
  const int na = static_cast<int>(a.size()), nb = static_cast<int>(b.size());
  if (std::abs(na - nb) > limit) return limit + 1;
  // Row i holds the distances of a's first i letters to each prefix of b.
  std::vector<int> row(nb + 1), above(nb + 1), above_that(nb + 1);
  for (int j = 0; j <= nb; ++j) row[j] = j;
  for (int i = 1; i <= na; ++i) {
    std::swap(above_that, above);
    std::swap(above, row);
    row[0] = i;
    for (int j = 1; j <= nb; ++j) {
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] != b[j - 1])});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], above_that[j - 2] + 1);
    }
  }
  return std::min(row[nb], limit + 1);
}

std::string find_nearest(std::string_view name, const std::vector<std::string>& names) {
  std::string nearest;
  int best = -1;
  for (const std::string& candidate : names) {
    const int size = static_cast<int>(candidate.size());
    const int limit = std::min(std::max(1, size / 3), size - 1);
    const int distance = edit_distance(name, candidate, limit);
    if (distance > limit || (best >= 0 && distance >= best)) continue;
    nearest = candidate;
    best = distance;
  }
  return nearest;
}

std::string list_names(const std::vector<std::string>& names, std::size_t most) {
  std::string list;
  for (std::size_t k = 0; k < std::min(most, names.size()); ++k)
    list += (k > 0 ? ", \"" : "\"") + names[k] + '"';
  return names.size() > most ? list + " and " + std::to_string(names.size() - most) + " more" : list;
}

}  // namespace weft::engine
