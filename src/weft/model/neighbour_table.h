#pragma once
/// The springs around each particle of a mesh, laid out for vector registers (sliced ELLPACK).
///
/// Particles go in slices of kLanes. A slice has as many entry rows as its busiest particle has springs:
///
///     slice s:   entry row 0:  j of particle 16s | of 16s+1 | … | of 16s+15
///                entry row 1:  …                  (unused places point to the particle itself)

#include <vector>

#include "weft/model/springs.h"

namespace weft::engine {

struct NeighbourTable {
  static constexpr int kLanes = 16;

  std::vector<int> slice_begin;    // (num_slices + 1) first entry row of each slice
  std::vector<int> neighbour;      // (num_entry_rows * kLanes) particle
  std::vector<int> spring;         // likewise: index of the spring, -1 where unused
  std::vector<float> rest_length;  // likewise: 0 where unused [m]

  int num_slices() const { return slice_begin.empty() ? 0 : static_cast<int>(slice_begin.size()) - 1; }
};

NeighbourTable build_neighbour_table(int num_particles, const std::vector<Spring>& springs);

}  // namespace weft::engine
