#include "weft/geometry/aabb_tree.h"

#include <numeric>

#include "weft/core/simd.h"

namespace weft {
namespace {

constexpr int kNodeGrain = 256;         // nodes per chunk of a query
constexpr std::size_t kMaxStarts = 32;  // parts of a tree that are held against another tree side by side
constexpr std::size_t kNumRanges = 32;  // parts of a tree that are built side by side

/// Sorts items into leaves: halves a range of whole leaves by the median of its longest side, again and
/// again. Ties are broken by the item's number, so that the parts do not depend on how the library finds a
/// median.
class Splitter {
 public:
  Splitter(const std::vector<Aabb>& boxes, int leaf_size)
      : leaf_size_(leaf_size), centers_(boxes.size()), items_(boxes.size()) {
    std::iota(items_.begin(), items_.end(), 0);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const float center = 0.5f * boxes[i].min[k] + 0.5f * boxes[i].max[k];
        centers_[i][k] = std::isfinite(center) ? center : 0.0f;
      }
    }
  }

  std::vector<int> split(JobSystem& jobs) {
    std::vector<Range> ranges = {{0, static_cast<int>(items_.size())}};
    while (ranges.size() < kNumRanges) {
      std::vector<Range> halves;
      for (const Range& r : ranges) {
        const int middle = halve(r);
        halves.push_back({r.begin, middle});
        if (middle < r.end) halves.push_back({middle, r.end});
      }
      if (halves.size() == ranges.size()) break;
      ranges = std::move(halves);
    }
    parallel_for(jobs, static_cast<int>(ranges.size()), 1, [&](int r, int) { split_below(ranges[r]); });
    return std::move(items_);
  }

 private:
  struct Range {
    int begin, end;
  };

  void split_below(const Range& range) {
    const int middle = halve(range);
    if (middle == range.end) return std::sort(items_.begin() + range.begin, items_.begin() + range.end);
    split_below({range.begin, middle});
    split_below({middle, range.end});
  }

  /// Where the right half begins; the range's end if all of it fits into a leaf.
  int halve(const Range& range) {
    const int num_leaves = (range.end - range.begin + leaf_size_ - 1) / leaf_size_;
    if (num_leaves <= 1) return range.end;
    const int middle = range.begin + num_leaves / 2 * leaf_size_;
    const int axis = longest_side(range);
    std::nth_element(items_.begin() + range.begin, items_.begin() + middle, items_.begin() + range.end,
                     [&](int a, int b) {
                       const float left = centers_[a][axis], right = centers_[b][axis];
                       return left < right || (left == right && a < b);
                     });
    return middle;
  }

  int longest_side(const Range& range) const {
    std::array<float, 3> low = centers_[items_[range.begin]], high = low;
    for (int i = range.begin + 1; i < range.end; ++i) {
      const std::array<float, 3>& c = centers_[items_[i]];
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], c[k]);
        high[k] = std::max(high[k], c[k]);
      }
    }
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
      if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    }
    return axis;
  }

  int leaf_size_;
  std::vector<std::array<float, 3>> centers_;
  std::vector<int> items_;
};

using aabb_tree::kLanes;

/// Which of the eight boxes b overlap box i of the eight boxes a and share no key with it: 1 each, else 0.
/// The result is 0 if none does.
template <bool kUsesKeys, class Leaf>
WEFT_ALWAYS_INLINE int test_lane(const Leaf& a, int i, const Leaf& b, int* hit) {
  const float min_x = a.min[0][i], min_y = a.min[1][i], min_z = a.min[2][i];
  const float max_x = a.max[0][i], max_y = a.max[1][i], max_z = a.max[2][i];
  const int p = a.key[0][i], q = a.key[1][i], r = a.key[2][i];
  int any = 0;
  for (int j = 0; j < kLanes; ++j) {
    const int overlaps = (min_x <= b.max[0][j]) & (b.min[0][j] <= max_x) & (min_y <= b.max[1][j]) &
                         (b.min[1][j] <= max_y) & (min_z <= b.max[2][j]) & (b.min[2][j] <= max_z);
    hit[j] = overlaps;
    if constexpr (kUsesKeys) {
      const int u = b.key[0][j], v = b.key[1][j], w = b.key[2][j];
      const int is_joined =
          (p == u) | (p == v) | (p == w) | (q == u) | (q == v) | (q == w) | (r == u) | (r == v) | (r == w);
      hit[j] &= is_joined ^ 1;
    }
    any |= hit[j];
  }
  return any;
}

/// Appends the pairs of items of each pair of leaves; of a leaf with itself each pair once.
template <bool kIsSelf, class Leaf, class LeafPair>
WEFT_ALWAYS_INLINE void test_leaf_pairs(const Leaf* left, const Leaf* right, const LeafPair* leaf_pairs,
                                        int count, std::vector<ItemPair>& pairs) {
  for (int n = 0; n < count; ++n) {
    const Leaf& a = left[leaf_pairs[n].a];
    const Leaf& b = right[leaf_pairs[n].b];
    const bool is_same = kIsSelf && leaf_pairs[n].a == leaf_pairs[n].b;
    alignas(64) int hits[kLanes][kLanes];
    int any = 0;
    for (int i = 0; i < kLanes; ++i) any |= test_lane<kIsSelf>(a, i, b, hits[i]);
    if (any == 0) continue;
    for (int i = 0; i < kLanes; ++i) {
      for (int j = is_same ? i + 1 : 0; j < kLanes; ++j) {
        // An infinite box overlaps even the empty ones that fill the last leaf.
        if (!hits[i][j] || a.item[i] < 0 || b.item[j] < 0) continue;
        const bool swaps = kIsSelf && b.item[j] < a.item[i];
        pairs.push_back(swaps ? ItemPair{b.item[j], a.item[i]} : ItemPair{a.item[i], b.item[j]});
      }
    }
  }
}

#define WEFT_LEAF_PAIRS                                                                              \
  (const aabb_tree::Leaf* left, const aabb_tree::Leaf* right, const aabb_tree::LeafPair* leaf_pairs, \
   int count, std::vector<ItemPair>& pairs)
#define WEFT_LEAF_PAIRS_ARGUMENTS (left, right, leaf_pairs, count, pairs)

WEFT_ALWAYS_INLINE void test_within_body WEFT_LEAF_PAIRS { test_leaf_pairs<true> WEFT_LEAF_PAIRS_ARGUMENTS; }
WEFT_ALWAYS_INLINE void test_between_body WEFT_LEAF_PAIRS {
  test_leaf_pairs<false> WEFT_LEAF_PAIRS_ARGUMENTS;
}
WEFT_MULTIVERSION(test_within, WEFT_LEAF_PAIRS, WEFT_LEAF_PAIRS_ARGUMENTS)
WEFT_MULTIVERSION(test_between, WEFT_LEAF_PAIRS, WEFT_LEAF_PAIRS_ARGUMENTS)

}  // namespace

void AabbTree::build(const std::vector<Aabb>& boxes, const std::vector<Keys>& keys, JobSystem& jobs) {
  num_items_ = static_cast<int>(boxes.size());
  const int num_leaves = (num_items_ + kLanes - 1) / kLanes;
  leaves_.assign(num_leaves, Leaf());
  nodes_.clear();
  const std::vector<int> items = Splitter(boxes, kLanes).split(jobs);
  for (int slot = 0; slot < num_leaves * kLanes; ++slot) {
    Leaf& leaf = leaves_[slot / kLanes];
    const int lane = slot % kLanes, item = slot < num_items_ ? items[slot] : -1;
    leaf.item[lane] = item;
    set_box(slot / kLanes, lane, item < 0 ? Aabb() : boxes[item]);
    const bool has_keys = item >= 0 && !keys.empty();
    for (int k = 0; k < 3; ++k) {
      const int own = -2 - 3 * slot - k;  // nobody else's
      leaf.key[k][lane] = has_keys && keys[item] != kNoKeys ? keys[item][k] : own;
    }
  }
  if (num_leaves == 0) return;
  nodes_.reserve(2 * num_leaves - 1);
  build_nodes(0, num_leaves);
  choose_starts();
  refit_nodes();
  built_area_ = total_area();
}

void AabbTree::build_nodes(int first_leaf, int num_leaves) {
  const int n = static_cast<int>(nodes_.size());
  nodes_.push_back({{}, 0, first_leaf});
  if (num_leaves == 1) return;
  build_nodes(first_leaf, num_leaves / 2);
  nodes_[n].right = static_cast<int>(nodes_.size());
  build_nodes(first_leaf + num_leaves / 2, num_leaves - num_leaves / 2);
}

void AabbTree::refit_nodes() {
  for (int n = static_cast<int>(nodes_.size()) - 1; n >= 0; --n) {
    Node& node = nodes_[n];
    node.box = Aabb();
    if (node.right != 0) {
      node.box.merge(nodes_[n + 1].box);
      node.box.merge(nodes_[node.right].box);
    } else {
      const Leaf& leaf = leaves_[node.leaf];
      for (int k = 0; k < 3; ++k) {
        node.box.min[k] = *std::min_element(leaf.min[k], leaf.min[k] + kLanes);
        node.box.max[k] = *std::max_element(leaf.max[k], leaf.max[k] + kLanes);
      }
    }
  }
}

float AabbTree::total_area() const {
  float sum = 0;
  for (const Node& node : nodes_) sum += node.box.half_area();
  return sum;
}

double AabbTree::looseness() const { return built_area_ > 0 ? total_area() / built_area_ : 1.0; }

bool AabbTree::meets_ray(const Aabb& box, const Vec3& origin, const Vec3& direction, double max_t) {
  double near = 0, far = max_t;
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 0) {
      if (origin[k] < box.min[k] || origin[k] > box.max[k]) return false;
      continue;
    }
    const double a = (box.min[k] - origin[k]) / direction[k], b = (box.max[k] - origin[k]) / direction[k];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  constexpr double kRounding = 1e-12;  // of the quotients: rather a box too many
  return near <= far + kRounding * (std::abs(near) + std::abs(far));
}

/// Goes down both trees at once, always into the larger part, to the pairs of leaves that overlap.
template <bool kCounts>
void AabbTree::collect(const AabbTree& other, LeafPair start, aabb_tree::Chunk& chunk) const {
  LeafPair stack[2 * kMaxDepth];
  int depth = 0;
  stack[depth++] = start;
  while (depth > 0) {
    const auto [n, m] = stack[--depth];
    const Node &a = nodes_[n], &b = other.nodes_[m];
    ++chunk.box_pairs;
    if (!(kCounts ? a.box.overlaps(b.box, chunk.comparisons) : a.box.overlaps(b.box))) continue;
    if (a.right == 0 && b.right == 0) {
      chunk.leaf_pairs.push_back({a.leaf, b.leaf});
    } else if (b.right == 0 || (a.right != 0 && a.right - n >= b.right - m)) {
      stack[depth++] = {a.right, m};
      stack[depth++] = {n + 1, m};
    } else {
      stack[depth++] = {n, b.right};
      stack[depth++] = {n, m + 1};
    }
  }
}

/// Runs find_leaf_pairs(begin, end, chunk) over [0, num_starts) in chunks, tests the leaves' items against
/// each other, and strings the chunks' results together in order.
template <class FindLeafPairs>
void AabbTree::find_in_chunks(int num_starts, int grain, const FindLeafPairs& find_leaf_pairs,
                              const AabbTree& other, bool is_self, JobSystem& jobs,
                              PairSearch& search) const {
  const std::size_t num_chunks = (num_starts + grain - 1) / grain;
  if (search.chunks.size() < num_chunks) search.chunks.resize(num_chunks);
  parallel_for(jobs, num_starts, grain, [&](int begin, int end) {
    aabb_tree::Chunk& chunk = search.chunks[begin / grain];
    chunk.leaf_pairs.clear();
    chunk.pairs.clear();
    chunk.box_pairs = chunk.comparisons = 0;
    find_leaf_pairs(begin, end, chunk);
    const auto test = is_self ? test_within : test_between;
    test(leaves_.data(), other.leaves_.data(), chunk.leaf_pairs.data(),
         static_cast<int>(chunk.leaf_pairs.size()), chunk.pairs);
    const std::int64_t lane_pairs = kLanes * kLanes * static_cast<std::int64_t>(chunk.leaf_pairs.size());
    chunk.box_pairs += lane_pairs;
    chunk.comparisons += 6 * lane_pairs;  // side by side: none is left out
  });
  search.pairs.clear();
  search.num_box_pairs = search.num_comparisons = 0;
  for (std::size_t c = 0; c < num_chunks; ++c) {
    const aabb_tree::Chunk& chunk = search.chunks[c];
    search.pairs.insert(search.pairs.end(), chunk.pairs.begin(), chunk.pairs.end());
    search.num_box_pairs += chunk.box_pairs;
    if (search.counts_comparisons) search.num_comparisons += chunk.comparisons;
  }
}

void AabbTree::find_self_pairs(JobSystem& jobs, PairSearch& search) const {
  // Each node's two halves are held against each other, and each leaf against itself.
  const auto find_leaf_pairs = [&](int begin, int end, aabb_tree::Chunk& chunk) {
    for (int n = begin; n < end; ++n) {
      const Node& node = nodes_[n];
      if (node.right != 0) {
        const LeafPair halves = {n + 1, node.right};
        search.counts_comparisons ? collect<true>(*this, halves, chunk) : collect<false>(*this, halves, chunk);
      } else {
        chunk.leaf_pairs.push_back({node.leaf, node.leaf});
      }
    }
  };
  find_in_chunks(static_cast<int>(nodes_.size()), kNodeGrain, find_leaf_pairs, *this, true, jobs, search);
}

void AabbTree::find_pairs(const AabbTree& other, JobSystem& jobs, PairSearch& search) const {
  search.pairs.clear();
  search.num_box_pairs = search.num_comparisons = 0;
  if (nodes_.empty() || other.nodes_.empty()) return;
  const auto find_leaf_pairs = [&](int begin, int end, aabb_tree::Chunk& chunk) {
    for (int s = begin; s < end; ++s) {
      const LeafPair start = {starts_[s], 0};
      search.counts_comparisons ? collect<true>(other, start, chunk) : collect<false>(other, start, chunk);
    }
  };
  find_in_chunks(static_cast<int>(starts_.size()), 1, find_leaf_pairs, other, false, jobs, search);
}

/// Nodes that together hold everything, a few dozen: parts that can be searched side by side.
void AabbTree::choose_starts() {
  starts_ = {0};
  while (starts_.size() < kMaxStarts) {
    std::vector<int> below;
    for (const int n : starts_) {
      if (nodes_[n].right == 0) {
        below.push_back(n);
      } else {
        below.insert(below.end(), {n + 1, nodes_[n].right});
      }
    }
    if (below.size() == starts_.size()) return;
    starts_ = std::move(below);
  }
}

}  // namespace weft
