#pragma once
/// The other family of the paper: space cut into equal cells. A peer for the tree in benchmarks, no more.

#include <cstdint>
#include <vector>

#include "weft/geometry/aabb.h"
#include "weft/geometry/aabb_tree.h"

namespace weft::engine::lab {

/// Every box is listed in each cell that it touches. The lists stand one after the other, sorted by a hash of
/// the cell, and boxes are compared with the others of their cell. Filled anew whenever boxes have moved.
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
