#include "weft/model/neighbour_table.h"

#include <algorithm>

namespace weft::engine {

NeighbourTable build_neighbour_table(int num_particles, const std::vector<Spring>& springs) {
  constexpr int kLanes = NeighbourTable::kLanes;
  std::vector<std::vector<int>> around(num_particles);
  for (int s = 0; s < static_cast<int>(springs.size()); ++s) {
    around[springs[s].i].push_back(s);
    around[springs[s].j].push_back(s);
  }

  NeighbourTable table;
  table.slice_begin.push_back(0);
  for (int first = 0; first < num_particles; first += kLanes) {
    std::size_t rows = 0;
    for (int p = first; p < std::min(first + kLanes, num_particles); ++p)
      rows = std::max(rows, around[p].size());
    for (std::size_t row = 0; row < rows; ++row) {
      for (int p = first; p < first + kLanes; ++p) {
        const bool used = p < num_particles && row < around[p].size();
        const int s = used ? around[p][row] : -1;
        table.spring.push_back(s);
        table.neighbour.push_back(used ? springs[s].i + springs[s].j - p : std::min(p, num_particles - 1));
        table.rest_length.push_back(used ? static_cast<float>(springs[s].rest_length) : 0.0f);
      }
    }
    table.slice_begin.push_back(table.slice_begin.back() + static_cast<int>(rows));
  }
  return table;
}

}  // namespace weft::engine
