#pragma once
/// The springs around each particle of a mesh, laid out for vector registers (sliced ELLPACK).
///
/// Particles are grouped in slices of kLanes. A slice has as many entry rows as the most springs of one
/// particle:
///
///     slice s:   entry row 0:  j of particle 16s | of 16s+1 | … | of 16s+15
///               entry row 1:  …                  (padding refers to the particle itself)

#include <vector>

#include "weft/model/springs.h"

namespace weft::engine {

struct NeighbourTable {
  static constexpr int kLanes = 16;

  std::vector<int> slice_begin;    // (num_slices + 1) first entry row of each slice
  std::vector<int> neighbour;      // (num_entry_rows * kLanes) particle index
  std::vector<int> spring;         // (num_entry_rows * kLanes) spring index, -1 in padding
  std::vector<float> rest_length;  // (num_entry_rows * kLanes) 0 in padding [m]

  int num_slices() const { return slice_begin.empty() ? 0 : static_cast<int>(slice_begin.size()) - 1; }
};

NeighbourTable build_neighbour_table(int num_particles, const std::vector<Spring>& springs);

}  // namespace weft::engine
