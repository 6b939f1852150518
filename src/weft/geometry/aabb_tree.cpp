#include "weft/geometry/aabb_tree.h"

#include <bit>
#include <numeric>

#include "weft/core/simd.h"

namespace weft::engine {
namespace {

constexpr int kNodesPerPart = 256;      // of a query
constexpr int kCopyGrain = 16;          // parts whose results are copied by one job
constexpr std::size_t kMaxStarts = 32;  // parts of a tree that are refitted in parallel
constexpr std::size_t kNumRanges = 32;  // parts of a tree that are built in parallel

/// Sorts items into leaves: recursive halving of a range of whole leaves by the median of its longest side.
/// Ties are broken by the item number, so that the parts do not depend on the library's median algorithm.
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

  /// The start of the right half; the range's end if all of it fits into a leaf.
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

// Before a loop over a leaf's items: if unrolled first, it is not vectorised.
#if defined(__GNUC__) && !defined(__clang__)
#define WEFT_ROLLED _Pragma("GCC unroll 1")
#else
#define WEFT_ROLLED
#endif

struct TreeView {
  const aabb_tree::Node* nodes;
  const aabb_tree::Leaf* leaves;
  const Aabb* node_ways;
  const aabb_tree::LeafWays* leaf_ways;
};

constexpr unsigned kBit[kLanes] = {1, 2, 4, 8, 16, 32, 64, 128};

/// Bit j: the leaf's box j overlaps the box from min to max.
template <class Leaf>
WEFT_ALWAYS_INLINE unsigned find_overlapping(const Leaf& leaf, const float* min, const float* max) {
  const float min_x = min[0], min_y = min[1], min_z = min[2], max_x = max[0], max_y = max[1], max_z = max[2];
  unsigned bits = 0;
  WEFT_ROLLED
  for (int j = 0; j < kLanes; ++j) {
    const unsigned overlaps = (min_x <= leaf.max[0][j]) & (leaf.min[0][j] <= max_x) &
                              (min_y <= leaf.max[1][j]) & (leaf.min[1][j] <= max_y) &
                              (min_z <= leaf.max[2][j]) & (leaf.min[2][j] <= max_z);
    bits |= kBit[j] & (0u - overlaps);
  }
  return bits;
}

/// Bit j: the leaf's item j may meet points in the box from min to max that move by way_min to way_max.
template <class Leaf>
WEFT_ALWAYS_INLINE unsigned find_meeting(const Leaf& leaf, const aabb_tree::LeafWays& ways, const float* min,
                                         const float* max, const float* way_min, const float* way_max) {
  unsigned apart[kLanes] = {};
  for (int k = 0; k < 3; ++k) {
    const float low = min[k], high = max[k], least = way_min[k], most = way_max[k];
    WEFT_ROLLED
    for (int j = 0; j < kLanes; ++j) {
      const float ahead = ways.max[k][j] - least, behind = most - ways.min[k][j];
      apart[j] |= static_cast<unsigned>(low > leaf.max[k][j] + (ahead > 0 ? ahead : 0.0f)) |
                  static_cast<unsigned>(leaf.min[k][j] > high + (behind > 0 ? behind : 0.0f));
    }
  }
  unsigned bits = 0;
  WEFT_ROLLED
  for (int j = 0; j < kLanes; ++j) bits |= kBit[j] & (apart[j] - 1);
  return bits;
}

/// Bit j: the leaf's item j has one of the keys.
template <class Leaf>
WEFT_ALWAYS_INLINE unsigned find_joined(const Leaf& leaf, int p, int q, int r) {
  unsigned bits = 0;
  WEFT_ROLLED
  for (int j = 0; j < kLanes; ++j) {
    const int u = leaf.key[0][j], v = leaf.key[1][j], w = leaf.key[2][j];
    const unsigned is_joined =
        (p == u) | (p == v) | (p == w) | (q == u) | (q == v) | (q == w) | (r == u) | (r == v) | (r == w);
    bits |= kBit[j] & (0u - is_joined);
  }
  return bits;
}

/// Appends the pairs of items of each pair of leaves; for a leaf with itself each pair once. First the items
/// of one leaf are tested against the whole other leaf, then those that overlap it against its items. Returns
/// the number of box–box comparisons.
template <bool kIsSelf, bool kMoves>
WEFT_ALWAYS_INLINE std::int64_t test_leaf_pairs(const TreeView& left, const TreeView& right,
                                                const std::vector<aabb_tree::NodePair>& leaf_pairs,
                                                std::vector<ItemPair>& pairs) {
  std::int64_t box_pairs = 0;
  for (const auto& [n, m] : leaf_pairs) {
    const int leaf_a = left.nodes[n].leaf, leaf_b = right.nodes[m].leaf;
    const aabb_tree::Leaf &a = left.leaves[leaf_a], &b = right.leaves[leaf_b];
    const Aabb& whole = right.nodes[m].box;
    const bool is_same = kIsSelf && n == m;
    unsigned rows = 0xff;
    if (!is_same) {
      if constexpr (kMoves) {
        rows = find_meeting(a, left.leaf_ways[leaf_a], whole.min.data(), whole.max.data(),
                            right.node_ways[m].min.data(), right.node_ways[m].max.data());
      } else {
        rows = find_overlapping(a, whole.min.data(), whole.max.data());
      }
    }
    box_pairs += (is_same ? 0 : kLanes) + kLanes * std::popcount(rows);
    std::uint64_t hits = 0;  // bit 8 i + j
    for (; rows != 0; rows &= rows - 1) {
      const int i = std::countr_zero(rows);
      const float min[3] = {a.min[0][i], a.min[1][i], a.min[2][i]};
      const float max[3] = {a.max[0][i], a.max[1][i], a.max[2][i]};
      unsigned row;
      if constexpr (kMoves) {
        const aabb_tree::LeafWays& ways = left.leaf_ways[leaf_a];
        const float way_min[3] = {ways.min[0][i], ways.min[1][i], ways.min[2][i]};
        const float way_max[3] = {ways.max[0][i], ways.max[1][i], ways.max[2][i]};
        row = find_meeting(b, right.leaf_ways[leaf_b], min, max, way_min, way_max);
      } else {
        row = find_overlapping(b, min, max);
      }
      if constexpr (kIsSelf) row &= ~find_joined(b, a.key[0][i], a.key[1][i], a.key[2][i]);
      if (is_same) row &= 0xfeu << i;
      hits |= std::uint64_t{row & 0xff} << (kLanes * i);
    }
    if (hits == 0) continue;
    ItemPair found[kLanes * kLanes];
    int num_found = 0;
    for (; hits != 0; hits &= hits - 1) {
      const int bit = std::countr_zero(hits);
      const int item_a = a.item[bit / kLanes], item_b = b.item[bit % kLanes];
      // An infinite box overlaps even the empty ones that fill the last leaf.
      if (item_a < 0 || item_b < 0) continue;
      found[num_found++] =
          kIsSelf ? ItemPair{std::min(item_a, item_b), std::max(item_a, item_b)} : ItemPair{item_a, item_b};
    }
    pairs.insert(pairs.end(), found, found + num_found);
  }
  return box_pairs;
}

#define WEFT_LEAF_PAIRS \
  (const TreeView& left, const TreeView& right, PairPart& found, std::int64_t& box_pairs)
#define WEFT_LEAF_PAIRS_ARGUMENTS (left, right, found, box_pairs)

WEFT_ALWAYS_INLINE void test_within_body WEFT_LEAF_PAIRS {
  box_pairs = test_leaf_pairs<true, false>(left, right, found.leaf_pairs, found.pairs);
}
WEFT_ALWAYS_INLINE void test_between_body WEFT_LEAF_PAIRS {
  box_pairs = test_leaf_pairs<false, false>(left, right, found.leaf_pairs, found.pairs);
}
WEFT_ALWAYS_INLINE void test_moving_within_body WEFT_LEAF_PAIRS {
  box_pairs = test_leaf_pairs<true, true>(left, right, found.leaf_pairs, found.pairs);
}
WEFT_ALWAYS_INLINE void test_moving_between_body WEFT_LEAF_PAIRS {
  box_pairs = test_leaf_pairs<false, true>(left, right, found.leaf_pairs, found.pairs);
}
WEFT_MULTIVERSION(test_within, WEFT_LEAF_PAIRS, WEFT_LEAF_PAIRS_ARGUMENTS)
WEFT_MULTIVERSION(test_between, WEFT_LEAF_PAIRS, WEFT_LEAF_PAIRS_ARGUMENTS)
WEFT_MULTIVERSION(test_moving_within, WEFT_LEAF_PAIRS, WEFT_LEAF_PAIRS_ARGUMENTS)
WEFT_MULTIVERSION(test_moving_between, WEFT_LEAF_PAIRS, WEFT_LEAF_PAIRS_ARGUMENTS)

}  // namespace

void AabbTree::build(const std::vector<Aabb>& boxes, const std::vector<Keys>& keys, JobSystem& jobs) {
  num_items_ = static_cast<int>(boxes.size());
  const int num_leaves = (num_items_ + kLanes - 1) / kLanes;
  leaves_.assign(num_leaves, Leaf());
  nodes_.clear();
  starts_.clear();
  start_ends_.clear();
  above_starts_.clear();
  const std::vector<int> items = Splitter(boxes, kLanes).split(jobs);
  for (int slot = 0; slot < num_leaves * kLanes; ++slot) {
    Leaf& leaf = leaves_[slot / kLanes];
    const int lane = slot % kLanes, item = slot < num_items_ ? items[slot] : -1;
    leaf.item[lane] = item;
    set_box(slot / kLanes, lane, item < 0 ? Aabb() : boxes[item]);
    const bool has_keys = item >= 0 && !keys.empty();
    for (int k = 0; k < 3; ++k) {
      const int own = -2 - 3 * slot - k;  // unique
      leaf.key[k][lane] = has_keys && keys[item] != kNoKeys ? keys[item][k] : own;
    }
  }
  if (num_leaves == 0) return;
  nodes_.reserve(2 * num_leaves - 1);
  build_nodes(0, num_leaves);
  is_marked_.reserve(nodes_.size());
  choose_starts();
  refit([&](int item) { return boxes[item]; }, jobs);
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
  constexpr double kRounding = 1e-12;  // of the quotients; errs towards a hit
  return near <= far + kRounding * (std::abs(near) + std::abs(far));
}

/// Descends both trees at once, always into the larger node, to the pairs of leaves that overlap.
template <class MayMeet>
void AabbTree::collect(const AabbTree& other, NodePair start, const MayMeet& may_meet,
                       PairPart& found) const {
  NodePair stack[2 * kMaxDepth];
  int depth = 0;
  stack[depth++] = start;
  while (depth > 0) {
    const auto [n, m] = stack[--depth];
    const Node &a = nodes_[n], &b = other.nodes_[m];
    ++found.box_pairs;
    if (!may_meet(n, m)) continue;
    if (a.right == 0 && b.right == 0) {
      found.leaf_pairs.push_back({n, m});
    } else if (b.right == 0 || (a.right != 0 && a.right - n >= b.right - m)) {
      stack[depth++] = {a.right, m};
      stack[depth++] = {n + 1, m};
    } else {
      stack[depth++] = {n, b.right};
      stack[depth++] = {n, m + 1};
    }
  }
}

void AabbTree::mark(std::span<const char> is_marked) {
  is_marked_.assign(nodes_.size(), 0);
  for (int n = static_cast<int>(nodes_.size()) - 1; n >= 0; --n) {
    const Node& node = nodes_[n];
    if (node.right != 0) {
      is_marked_[n] = is_marked_[n + 1] | is_marked_[node.right];
      continue;
    }
    for (int lane = 0; lane < num_items_in(node.leaf); ++lane)
      is_marked_[n] |= is_marked[leaves_[node.leaf].item[lane]];
  }
}

void AabbTree::find_leaf_pairs(const AabbTree& other, NodePair start, Extent extent, bool counts,
                               PairPart& found) const {
  if (moves_ && other.moves_ && extent == Extent::marked) {
    collect(
        other, start,
        [&](int n, int m) {
          return (is_marked_[n] || other.is_marked_[m]) && moving(n).may_meet(other.moving(m));
        },
        found);
  } else if (moves_ && other.moves_) {
    collect(
        other, start, [&](int n, int m) { return moving(n).may_meet(other.moving(m)); }, found);
  } else if (counts) {
    collect(
        other, start,
        [&](int n, int m) { return nodes_[n].box.overlaps(other.nodes_[m].box, found.comparisons); }, found);
  } else {
    collect(
        other, start, [&](int n, int m) { return nodes_[n].box.overlaps(other.nodes_[m].box); }, found);
  }
}

/// Tests the leaves' items against each other.
void AabbTree::test_leaves(const AabbTree& other, bool is_self, PairPart& found) const {
  const auto view = [](const AabbTree& tree) -> TreeView {
    return {tree.nodes_.data(), tree.leaves_.data(), tree.node_ways_.data(), tree.leaf_ways_.data()};
  };
  const auto test = moves_ && other.moves_ ? (is_self ? test_moving_within : test_moving_between)
                                           : (is_self ? test_within : test_between);
  std::int64_t box_pairs = 0;
  test(view(*this), view(other), found, box_pairs);
  found.box_pairs += box_pairs;
  found.comparisons += 6 * box_pairs;  // in SIMD: none is skipped
}

int AabbTree::num_self_parts() const {
  return (static_cast<int>(nodes_.size()) + kNodesPerPart - 1) / kNodesPerPart;
}

void AabbTree::find_self_part(int part, Extent extent, PairPart& found) const {
  find_self_part(part, extent, false, found);
}

/// Tests each node's two halves against each other, and each leaf against itself.
void AabbTree::find_self_part(int part, Extent extent, bool counts, PairPart& found) const {
  found.clear();
  const int begin = part * kNodesPerPart,
            end = std::min(begin + kNodesPerPart, static_cast<int>(nodes_.size()));
  for (int n = begin; n < end; ++n) {
    const Node& node = nodes_[n];
    if (extent == Extent::marked && !is_marked_[n]) continue;
    if (node.right != 0) {
      find_leaf_pairs(*this, {n + 1, node.right}, extent, counts, found);
    } else {
      found.leaf_pairs.push_back({n, n});
    }
  }
  test_leaves(*this, true, found);
}

int AabbTree::num_parts_with(const AabbTree& other) const {
  return nodes_.empty() || other.nodes_.empty() ? 0 : static_cast<int>(starts_.size());
}

void AabbTree::find_part(const AabbTree& other, int part, Extent extent, PairPart& found) const {
  find_part(other, part, extent, false, found);
}

void AabbTree::find_part(const AabbTree& other, int part, Extent extent, bool counts, PairPart& found) const {
  found.clear();
  find_leaf_pairs(other, {starts_[part], 0}, extent, counts, found);
  test_leaves(other, false, found);
}

/// Runs find_part(part, found) for all parts, and concatenates their results in order.
template <class FindPart>
void AabbTree::find_all(int num_parts, const FindPart& find_part, JobSystem& jobs, PairSearch& search) {
  if (static_cast<int>(search.parts.size()) < num_parts) search.parts.resize(num_parts);
  parallel_for(jobs, num_parts, 1, [&](int part, int) { find_part(part, search.parts[part]); });
  search.num_box_pairs = search.num_comparisons = 0;
  std::size_t num_pairs = 0;
  for (int p = 0; p < num_parts; ++p) {
    PairPart& part = search.parts[p];
    part.first = num_pairs;
    num_pairs += part.pairs.size();
    search.num_box_pairs += part.box_pairs;
    if (search.counts_comparisons) search.num_comparisons += part.comparisons;
  }
  search.pairs.resize(num_pairs);
  parallel_for(jobs, num_parts, kCopyGrain, [&](int begin, int end) {
    for (int p = begin; p < end; ++p) {
      const PairPart& part = search.parts[p];
      std::copy(part.pairs.begin(), part.pairs.end(), search.pairs.begin() + part.first);
    }
  });
}

void AabbTree::find_self_pairs(JobSystem& jobs, PairSearch& search, Extent extent) const {
  const auto find = [&](int part, PairPart& found) {
    find_self_part(part, extent, search.counts_comparisons, found);
  };
  find_all(num_self_parts(), find, jobs, search);
}

void AabbTree::find_pairs(const AabbTree& other, JobSystem& jobs, PairSearch& search, Extent extent) const {
  const auto find = [&](int part, PairPart& found) {
    find_part(other, part, extent, search.counts_comparisons, found);
  };
  find_all(num_parts_with(other), find, jobs, search);
}

/// Splits the tree recursively into a few dozen subtrees.
void AabbTree::choose_starts() {
  starts_ = {0};
  while (starts_.size() < kMaxStarts) {
    std::vector<int> below;
    for (const int n : starts_) {
      if (nodes_[n].right == 0) {
        below.push_back(n);
      } else {
        above_starts_.push_back(n);
        below.insert(below.end(), {n + 1, nodes_[n].right});
      }
    }
    if (below.size() == starts_.size()) break;
    starts_ = std::move(below);
  }
  std::sort(above_starts_.begin(), above_starts_.end());
  const int num_leaves = static_cast<int>(leaves_.size());
  for (std::size_t s = 0; s < starts_.size(); ++s) {
    const int end_leaf = s + 1 < starts_.size() ? nodes_[starts_[s + 1]].leaf : num_leaves;
    start_ends_.push_back(starts_[s] + 2 * (end_leaf - nodes_[starts_[s]].leaf) - 1);
  }
}

}  // namespace weft::engine
