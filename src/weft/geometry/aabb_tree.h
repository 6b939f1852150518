#pragma once
/// Bounding volume hierarchy of AABBs over triangles, edges, points or any items with a box.
///
///                    [ all ]                  Leaves hold up to eight items, interleaved for SIMD. A tree is
///               [ ... ]   [ ... ]             built once, refitted to moved items in linear time, and
///            [8][8][8]     [8][8][5]          rebuilt when it has become loose.
///
/// The result of a query does not depend on the tree's shape; the order of the result does.

#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "weft/core/job_system.h"
#include "weft/geometry/aabb.h"

namespace weft::engine {

struct ItemPair {
  int a = 0, b = 0;
  bool operator==(const ItemPair&) const = default;
  auto operator<=>(const ItemPair&) const = default;
};

/// Private to the tree.
namespace aabb_tree {

constexpr int kLanes = 8;

/// Eight items, interleaved for SIMD; the empty lanes of the last leaf have empty boxes.
struct Leaf {
  float min[3][kLanes], max[3][kLanes];
  int key[3][kLanes];
  int item[kLanes];
};

/// Displacement bounds of a leaf's items.
struct LeafWays {
  float min[3][kLanes], max[3][kLanes];
};

/// In preorder: the left child follows its parent.
struct Node {
  Aabb box;
  int right = 0;  // the right child's index, 0 at a leaf
  int leaf = 0;   // the first leaf below
};

struct NodePair {
  int a, b;
};

}  // namespace aabb_tree

/// The result of a part of a query. Reuse it to avoid allocations.
struct PairPart {
  std::vector<ItemPair> pairs;

  // Private to the tree.
  std::vector<aabb_tree::NodePair> leaf_pairs;  // pairs of leaf nodes
  std::int64_t box_pairs = 0, comparisons = 0;
  std::size_t first = 0;  // position of its pairs in the whole result

  void clear() {
    pairs.clear();
    leaf_pairs.clear();
    box_pairs = comparisons = 0;
  }
};

/// The result of a query for pairs. Reuse it: queries do not allocate once it has grown.
struct PairSearch {
  std::vector<ItemPair> pairs;
  std::int64_t num_box_pairs = 0;  // boxes compared with boxes, by six comparisons at most [1]

  bool counts_comparisons = false;   // set it to count comparisons, which is slower
  std::int64_t num_comparisons = 0;  // number comparisons in box tests [1]

  std::vector<PairPart> parts;  // private to the tree
};

class AabbTree {
 public:
  /// Shared features of items, such as a triangle's vertices: a query of the tree with itself does not report
  /// pairs of items with a common key. Items without keys: kNoKeys.
  using Keys = std::array<int, 3>;
  static constexpr Keys kNoKeys = {-1, -1, -1};

  /// The items that refit() and queries process: all, or only marked ones.
  enum class Extent { all, marked };

  /// Builds the tree over `boxes` (num_items), split at medians. `keys` is (num_items) or empty.
  void build(const std::vector<Aabb>& boxes, const std::vector<Keys>& keys, JobSystem& jobs);

  /// Refits the tree to moved boxes: box_of(item) returns an item's box, an Aabb or a MovingAabb.
  /// If both trees of a query were last fitted to moving boxes, it returns the pairs that may meet; otherwise
  /// the pairs that overlap at present.
  /// With Extent::marked, the boxes of all other items must be unchanged since the last time.
  template <class BoxOf>
  void refit(const BoxOf& box_of, JobSystem& jobs, Extent extent = Extent::all) {
    moves_ = std::is_same_v<decltype(box_of(0)), MovingAabb>;
    if (moves_) {
      node_ways_.resize(nodes_.size());
      leaf_ways_.resize(leaves_.size());
    }
    parallel_for(jobs, static_cast<int>(starts_.size()), 1, [&](int s, int) {
      for (int n = start_ends_[s] - 1; n >= starts_[s]; --n) {
        if (extent == Extent::marked && !is_marked_[n]) continue;
        nodes_[n].right != 0 ? refit_node(n) : refit_leaf(n, box_of);
      }
    });
    for (auto n = above_starts_.rbegin(); n != above_starts_.rend(); ++n) refit_node(*n);
  }

  /// Marks items (num_items).
  void mark(std::span<const char> is_marked);

  int num_items() const { return num_items_; }

  /// The total surface area of all nodes, relative to that after the build: about 1 for a tight tree. The
  /// larger it is, the more boxes a query tests. 2 is a good value for a rebuild.
  double looseness() const;

  /// All pairs of items whose boxes overlap and that share no key, each once with a < b. With Extent::marked:
  /// all pairs with a marked item, and perhaps others.
  void find_self_pairs(JobSystem& jobs, PairSearch& search, Extent extent = Extent::all) const;

  /// All pairs of an item a of this tree and an item b of another one whose boxes overlap, whatever their
  /// keys. With Extent::marked, for which both trees must be marked, as above.
  void find_pairs(const AabbTree& other, JobSystem& jobs, PairSearch& search,
                  Extent extent = Extent::all) const;

  /// The same queries in independent parts, on any thread, for callers that need not keep all pairs: the
  /// parts in [0, num_self_parts()), or [0, num_parts_with(other)), together find the pairs of the whole
  /// query.
  int num_self_parts() const;
  void find_self_part(int part, Extent extent, PairPart& found) const;
  int num_parts_with(const AabbTree& other) const;
  void find_part(const AabbTree& other, int part, Extent extent, PairPart& found) const;

  /// Calls visit(item) for all items whose boxes overlap `box`.
  template <class Visit>
  void for_each_overlapping(const Aabb& box, const Visit& visit) const {
    descend([&](const Aabb& node) { return node.overlaps(box); }, always_left_first, visit);
  }

  /// Calls visit(item) for all items whose boxes the ray may meet:
  /// { origin + t direction : 0 <= t <= max_t }. visit returns the new limit of t (max_t to visit all).
  template <class Visit>
  void for_each_along_ray(const Vec3& origin, const Vec3& direction, double max_t, const Visit& visit) const {
    double reach = max_t;
    descend([&](const Aabb& node) { return meets_ray(node, origin, direction, reach); }, always_left_first,
            [&](int item) { reach = std::min(reach, visit(item)); });
  }

  /// The item nearest to p, or -1 if none is nearer than `max_distance_sq`: distance_sq(item) returns an
  /// item's squared distance, at least that of its box. Of equally near items, the lowest one.
  template <class DistanceSq>
  int find_nearest(const Vec3& p, double max_distance_sq, const DistanceSq& distance_sq) const {
    int nearest = -1;
    double best = max_distance_sq;
    descend([&](const Aabb& box) { return box.distance_sq(p) <= best; },
            [&](const Aabb& left, const Aabb& right) { return left.distance_sq(p) <= right.distance_sq(p); },
            [&](int item) {
              const double d = distance_sq(item);
              if (d < best || (d == best && nearest >= 0 && item < nearest)) {
                best = d;
                nearest = item;
              }
            });
    return nearest;
  }

 private:
  static constexpr int kMaxDepth = 64;

  using Leaf = aabb_tree::Leaf;
  using Node = aabb_tree::Node;
  using NodePair = aabb_tree::NodePair;
  static constexpr int kLanes = aabb_tree::kLanes;

  int num_items_in(int leaf) const { return std::min(kLanes, num_items_ - leaf * kLanes); }

  void set_box(int leaf, int lane, const Aabb& box) {
    for (int k = 0; k < 3; ++k) {
      leaves_[leaf].min[k][lane] = box.min[k];
      leaves_[leaf].max[k][lane] = box.max[k];
    }
  }

  Aabb box_of_lane(const Leaf& leaf, int lane) const {
    return {{leaf.min[0][lane], leaf.min[1][lane], leaf.min[2][lane]},
            {leaf.max[0][lane], leaf.max[1][lane], leaf.max[2][lane]}};
  }

  static bool meets_ray(const Aabb& box, const Vec3& origin, const Vec3& direction, double max_t);

  /// Visits the items for which IsWanted accepts their box and all boxes above it; the left child first where
  /// is_left_first(left box, right box) returns true.
  template <class IsWanted, class IsLeftFirst, class Visit>
  void descend(const IsWanted& is_wanted, const IsLeftFirst& is_left_first, const Visit& visit) const {
    if (nodes_.empty()) return;
    int stack[kMaxDepth];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const int n = stack[--depth];
      const Node& node = nodes_[n];
      if (!is_wanted(node.box)) continue;
      if (node.right != 0) {
        const bool left_first = is_left_first(nodes_[n + 1].box, nodes_[node.right].box);
        stack[depth++] = left_first ? node.right : n + 1;
        stack[depth++] = left_first ? n + 1 : node.right;
        continue;
      }
      const Leaf& leaf = leaves_[node.leaf];
      for (int lane = 0; lane < num_items_in(node.leaf); ++lane) {
        if (is_wanted(box_of_lane(leaf, lane))) visit(leaf.item[lane]);
      }
    }
  }

  static bool always_left_first(const Aabb&, const Aabb&) { return true; }

  void build_nodes(int first_leaf, int num_leaves);
  void choose_starts();
  void refit_node(int n) {
    const int right = nodes_[n].right;
    nodes_[n].box = nodes_[n + 1].box;
    nodes_[n].box.merge(nodes_[right].box);
    if (!moves_) return;
    node_ways_[n] = node_ways_[n + 1];
    node_ways_[n].merge(node_ways_[right]);
  }

  template <class BoxOf>
  void refit_leaf(int n, const BoxOf& box_of) {
    const int leaf = nodes_[n].leaf;
    MovingAabb all;
    if (moves_) leaf_ways_[leaf] = {};
    for (int lane = 0; lane < num_items_in(leaf); ++lane) {
      const auto item = box_of(leaves_[leaf].item[lane]);
      if constexpr (std::is_same_v<decltype(box_of(0)), MovingAabb>) {
        set_box(leaf, lane, item.box);
        set_way(leaf, lane, item.way);
        all.merge(item);
      } else {
        set_box(leaf, lane, item);
        all.box.merge(item);
      }
    }
    nodes_[n].box = all.box;
    if (moves_) node_ways_[n] = all.way;
  }

  void set_way(int leaf, int lane, const Aabb& way) {
    for (int k = 0; k < 3; ++k) {
      leaf_ways_[leaf].min[k][lane] = way.min[k];
      leaf_ways_[leaf].max[k][lane] = way.max[k];
    }
  }

  MovingAabb moving(int n) const { return {nodes_[n].box, node_ways_[n]}; }
  float total_area() const;
  template <class MayMeet>
  void collect(const AabbTree& other, NodePair start, const MayMeet& may_meet, PairPart& found) const;
  void find_leaf_pairs(const AabbTree& other, NodePair start, Extent extent, bool counts,
                       PairPart& found) const;
  void find_self_part(int part, Extent extent, bool counts, PairPart& found) const;
  void find_part(const AabbTree& other, int part, Extent extent, bool counts, PairPart& found) const;
  void test_leaves(const AabbTree& other, bool is_self, PairPart& found) const;
  template <class FindPart>
  static void find_all(int num_parts, const FindPart& find_part, JobSystem& jobs, PairSearch& search);

  int num_items_ = 0;
  float built_area_ = 0;
  std::vector<Leaf> leaves_;
  std::vector<Node> nodes_;
  bool moves_ = false;  // fitted to moving boxes
  std::vector<aabb_tree::LeafWays> leaf_ways_;
  std::vector<Aabb> node_ways_;
  std::vector<char> is_marked_;    // (nodes) a marked item is below
  std::vector<int> starts_;        // roots of disjoint subtrees that cover all items, for parallel refits
  std::vector<int> start_ends_;    // one past the last node below each
  std::vector<int> above_starts_;  // all nodes above them, ascending
};

}  // namespace weft::engine
