#pragma once
/// Uniform grid, the other broad phase of the paper. Used only for comparison with the tree in benchmarks.

#include <cstdint>
#include <vector>

#include "weft/geometry/aabb.h"
#include "weft/geometry/aabb_tree.h"

namespace weft::engine::lab {

/// Spatial hashing: every box is listed in each cell that it overlaps. The lists are contiguous, sorted by a
/// hash of the cell; boxes are compared within their cells. Rebuilt whenever boxes have moved.
class UniformGrid {
 public:
  /// `cell` is the side of a cell [m].
  void fill(const std::vector<Aabb>& boxes, double cell);

  /// All pairs of items whose boxes overlap and that share no key, each once with a < b.
  void find_self_pairs(const std::vector<Aabb>& boxes, const std::vector<AabbTree::Keys>& keys,
                       PairSearch& search) const;

 private:
  struct Cell {
    int x, y, z;
    bool operator==(const Cell&) const = default;
  };
  struct Entry {
    Cell cell;
    int item;
  };

  std::uint32_t bucket_of(const Cell& c) const;
  Cell cell_at(float x, float y, float z) const;
  template <class Visit>
  void for_each_cell(const Aabb& box, const Visit& visit) const;

  float inverse_cell_ = 1;
  std::uint32_t mask_ = 0;
  std::vector<int> begin_;  // (buckets + 1) of entries_
  std::vector<int> next_;
  std::vector<Entry> entries_;
};

}  // namespace weft::engine::lab
