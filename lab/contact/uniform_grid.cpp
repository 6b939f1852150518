#include "lab/contact/uniform_grid.h"

#include <bit>
#include <cmath>

namespace weft::engine::lab {

std::uint32_t UniformGrid::bucket_of(const Cell& c) const {
  std::uint32_t h = static_cast<std::uint32_t>(c.x) * 0x9e3779b1u;
  h ^= static_cast<std::uint32_t>(c.y) * 0x85ebca77u;
  h ^= static_cast<std::uint32_t>(c.z) * 0xc2b2ae3du;
  h ^= h >> 15;
  return h & mask_;
}

UniformGrid::Cell UniformGrid::cell_at(float x, float y, float z) const {
  const auto index = [&](float value) { return static_cast<int>(std::floor(value * inverse_cell_)); };
  return {index(x), index(y), index(z)};
}

template <class Visit>
void UniformGrid::for_each_cell(const Aabb& box, const Visit& visit) const {
  const Cell low = cell_at(box.min[0], box.min[1], box.min[2]);
  const Cell high = cell_at(box.max[0], box.max[1], box.max[2]);
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) visit(Cell{x, y, z});
    }
  }
}

void UniformGrid::fill(const std::vector<Aabb>& boxes, double cell) {
  inverse_cell_ = static_cast<float>(1 / cell);
  mask_ = std::bit_ceil(static_cast<std::uint32_t>(2 * boxes.size() + 1)) - 1;
  begin_.assign(mask_ + 2, 0);
  for (const Aabb& box : boxes) {
    for_each_cell(box, [&](const Cell& c) { ++begin_[bucket_of(c) + 1]; });
  }
  for (std::size_t b = 1; b < begin_.size(); ++b) begin_[b] += begin_[b - 1];
  next_.assign(begin_.begin(), begin_.end() - 1);
  entries_.resize(begin_.back());
  for (int i = 0; i < static_cast<int>(boxes.size()); ++i) {
    for_each_cell(boxes[i], [&](const Cell& c) { entries_[next_[bucket_of(c)]++] = {c, i}; });
  }
}

/// A pair in several cells is reported only in the cell of the lower corner of the boxes' intersection.
void UniformGrid::find_self_pairs(const std::vector<Aabb>& boxes, const std::vector<AabbTree::Keys>& keys,
                                  PairSearch& search) const {
  search.pairs.clear();
  search.num_box_pairs = 0;
  const auto share_key = [&](int a, int b) {
    const auto& [p, q, r] = keys[a];
    const auto& [u, v, w] = keys[b];
    return p == u || p == v || p == w || q == u || q == v || q == w || r == u || r == v || r == w;
  };
  for (std::uint32_t bucket = 0; bucket <= mask_; ++bucket) {
    for (int m = begin_[bucket]; m < begin_[bucket + 1]; ++m) {
      const Entry& a = entries_[m];
      const Aabb& box_a = boxes[a.item];
      for (int n = m + 1; n < begin_[bucket + 1]; ++n) {
        const Entry& b = entries_[n];
        if (b.cell != a.cell) continue;
        const Aabb& box_b = boxes[b.item];
        ++search.num_box_pairs;
        if (!box_a.overlaps(box_b) || share_key(a.item, b.item)) continue;
        const Cell first = cell_at(std::max(box_a.min[0], box_b.min[0]), std::max(box_a.min[1], box_b.min[1]),
                                   std::max(box_a.min[2], box_b.min[2]));
        if (first == a.cell) search.pairs.push_back({a.item, b.item});
      }
    }
  }
}

}  // namespace weft::engine::lab
