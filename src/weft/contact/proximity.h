#pragma once
/// Broad phase: the vertex–triangle and edge–edge pairs that may come close during a step.

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "weft/contact/patches.h"
#include "weft/contact/surface.h"
#include "weft/contact/swept_box.h"
#include "weft/core/job_system.h"
#include "weft/core/work_times.h"
#include "weft/geometry/aabb_tree.h"
#include "weft/geometry/distance.h"

namespace weft::engine {

/// Positions of all vertices of the Surface at the start and at the end of a step, and their half thickness.
struct SurfaceMotion {
  std::vector<Vec3> start, end;        // (num_vertices) [m]
  std::vector<double> half_thickness;  // (num_vertices) features are close within the sum of both [m]
};

/// A vertex and a triangle, or two edges.
struct FeaturePair {
  int a = 0, b = 0;
  float max_gap = std::numeric_limits<float>::infinity();  // features near at rest may come this close [m]
};

/// Verlet lists of close pairs: a vertex's pairs stay valid while its motion, relative to the mean of all
/// cloth, is within `slack`; otherwise they are searched again. Lists are conservative: they may hold pairs
/// that are not close, never miss one that is, and have a fixed order.
///
/// The search works on patches (patches.h): those that cannot meet themselves are skipped, and an AABB tree
/// of moving boxes gives the pairs of the others. Parts that move together do not meet, at any speed.
class Proximity {
 public:
  /// Verlet slack: how far vertices may move before pairs are searched again. `most` where few pairs are
  /// near, `least` where many are [m].
  struct Slack {
    double most = 0, least = 0;
    double narrow = 0;  // triangles at a vertex that seem narrower than this may turn over [m]
  };

  /// The first `num_cloth_triangles` triangles and the first `num_cloth_vertices` vertices are cloth; the
  /// others are colliders', which are not tested against each other. `rest` (num_cloth_vertices) are the rest
  /// positions, which distinguish mesh neighbours from folds [m]. `patches` hold every triangle once.
  void reset(Surface surface, Patches patches, std::vector<Vec3> rest, int num_cloth_vertices,
             int num_cloth_triangles, const Slack& slack);

  /// Collision filter: the body of each triangle (triangles), and the symmetric table `non_colliding`
  /// (bodies, bodies) of those that do not collide; empty: all collide. Pairs of such bodies are not listed.
  void set_bodies(std::vector<int> body_of_triangle) { body_of_triangle_ = std::move(body_of_triangle); }
  void set_non_colliding(const std::vector<char>& non_colliding);

  /// Updates the lists for this motion. If cloth of many triangles moves against itself by more than its own
  /// size, all pairs are near: the lists are left empty, and diverged_vertex() returns a vertex. Cloth may be
  /// nearer to itself at rest than its thickness (short edges, pleats, a lining) and stay so:
  /// FeaturePair::max_gap.
  void update(const SurfaceMotion& motion, JobSystem& jobs);

  /// As update(), but only the given pairs of cloth patches may meet, a <= b, each once: all others stay
  /// apart by more than the sum of half thicknesses and twice the slack [m]. No mesh colliders are near.
  void update_among(const SurfaceMotion& motion, std::span<const ItemPair> patch_pairs, double slack,
                    JobSystem& jobs);

  /// Measures the time of updates from now on; null: off.
  void measure(WorkClock* clock) { clock_ = clock; }

  /// The fastest vertex when the last update gave up on diverged cloth, -1 if it did not.
  int diverged_vertex() const { return diverged_vertex_; }

  const Surface& surface() const { return surface_; }
  const std::vector<FeaturePair>& vertex_triangle() const { return vertex_triangle_; }
  const std::vector<FeaturePair>& edge_edge() const { return edge_edge_; }

  /// Upper bound for the present length of cloth edges [m].
  double longest_edge();

 private:
  /// Two patches that may meet, or one patch with itself.
  struct PatchPair {
    int a = 0, b = 0;  // a <= b
    bool are_neighbours = false;
    bool is_new = true;  // search all its features, not only those that moved

    auto operator<=>(const PatchPair& other) const { return a != other.a ? a <=> other.a : b <=> other.b; }
    bool operator==(const PatchPair& other) const { return a == other.a && b == other.b; }
  };

  struct PairChunk {
    std::vector<FeaturePair> vertex_triangle, edge_edge;

    void clear() {
      vertex_triangle.clear();
      edge_edge.clear();
    }
  };

  /// Vertex positions (num_vertices) relative to origin_, and patch deformations (cloth patches) at one time.
  struct Moment {
    std::vector<Float4> x;
    std::vector<PatchDeformation> patches;
  };

  void find_tight(const std::vector<double>& half_thickness, JobSystem& jobs);
  int body_of(int vertex) const;
  void find_moved(const SurfaceMotion& motion);
  void find_drift(const SurfaceMotion& motion);
  void choose_slack();
  void rebuild(const SurfaceMotion& motion, JobSystem& jobs);
  void mark_patches(std::span<const ItemPair> patch_pairs);
  bool is_non_colliding(int triangle, int other) const;
  bool renew(const SurfaceMotion& motion, JobSystem& jobs);
  void mark_moved(const SurfaceMotion& motion);
  void drop_pairs_of_moved();
  void measure_patches(JobSystem& jobs);
  void find_folded();
  SweptBox box_of(std::span<const int> vertices) const;
  int find_diverged_vertex(const SurfaceMotion& motion) const;
  void build_tree(AabbTree& tree, int begin, int end, JobSystem& jobs);
  bool refit_tree(AabbTree& tree, int begin, AabbTree::Extent extent, JobSystem& jobs);
  bool has_bodies() const { return patches_.size() > patches_.num_cloth(); }
  void find_near_patches(AabbTree::Extent extent, JobSystem& jobs);
  void measure_triangles(JobSystem& jobs);
  void find_pairs(JobSystem& jobs);
  template <class Add>
  void add_pairs(int count, int grain, const Add& add, JobSystem& jobs);
  void put_in_order(int end_of_a, std::vector<FeaturePair>& pairs);
  void add_pairs_of_patches(const PatchPair& pair, PairChunk& chunk) const;
  bool stay_apart(int first, int second) const;
  void add_pairs_of_triangles(int first, int second, const SweptBox& box_a, const SweptBox& box_b,
                              bool is_one_ring_pair, PairChunk& chunk) const;
  void add_vertex_triangle(int vertex, int triangle, bool is_one_ring_pair, PairChunk& chunk) const;
  void add_edge_edge(int a, int b, bool is_one_ring_pair, PairChunk& chunk) const;
  template <std::size_t kA, std::size_t kB, class Distance>
  void add_pair(FeaturePair pair, const std::array<int, kA>& a, const std::array<int, kB>& b,
                bool is_one_ring_pair, const Distance& distance, std::vector<FeaturePair>& pairs) const;
  PointTriangleDistance distance_to_triangle(const FeaturePair& pair, const std::vector<Vec3>& x) const;
  EdgeEdgeDistance distance_of_edges(const FeaturePair& pair, const std::vector<Vec3>& x) const;
  bool are_tight(int vertex, int other) const;
  bool are_beside(std::span<const int> a, std::span<const int> b) const;
  template <std::size_t kA, std::size_t kB>
  double reach_between(const std::array<int, kA>& a, const std::array<int, kB>& b) const;
  bool is_sharp(int vertex, const std::vector<Float4>& x) const;
  void find_one_ring_pairs(JobSystem& jobs);

  WorkClock* clock_ = nullptr;
  Surface surface_;
  std::vector<Vec3> rest_;
  int num_cloth_vertices_ = 0, num_cloth_triangles_ = 0;
  std::vector<int> body_of_triangle_;
  std::vector<char> is_tight_;     // (num_vertices) nearer to its own cloth at rest than its thickness …
  std::vector<double> tight_for_;  // … for these half thicknesses; empty: out of date [m]
  std::vector<char> non_colliding_;
  std::size_t num_bodies_ = 0;
  Slack slacks_;
  double slack_ = 0;       // for the next lists [m]
  double made_with_ = 0;   // of the present lists [m]
  bool is_among_ = false;  // the present lists cover some patches; only these are measured
  int num_calm_ = 0;       // consecutive searches that found few pairs

  Patches patches_;
  AabbTree cloth_tree_, body_tree_;  // of patches
  SurfaceMotion made_for_;           // motion at the last search, up to a common drift; or empty
  Vec3 origin_ = Vec3::Zero();       // of the boxes
  std::vector<FeaturePair> vertex_triangle_, edge_edge_;
  std::optional<double> longest_edge_;  // at the last search, if requested [m]
  int diverged_vertex_ = -1;

  // State at the last search.
  Moment at_start_, at_end_;
  std::vector<float> margin_;           // (num_vertices) slack, half thickness and float rounding [m]
  std::vector<SweptBox> patch_box_;     // (patches)
  std::vector<char> is_flat_;           // (windows) no self contact is possible
  std::vector<PatchPair> patch_pairs_;  // whose features are listed, in order

  // Parts to be searched again.
  std::vector<int> moved_;  // vertices
  Vec3 drift_at_start_ = Vec3::Zero(), drift_at_end_ = Vec3::Zero();
  std::vector<char> is_moved_;          // (num_vertices)
  std::vector<char> is_renewed_;        // (triangles) has one of them
  std::vector<char> is_near_;           // (num_vertices) in one of these triangles
  std::vector<char> is_renewed_patch_;  // (patches) has one of these triangles

  // Work space.
  std::vector<PatchPair> patch_pairs_before_;
  std::vector<ItemPair> near_patches_;
  std::vector<PairPart> parts_;
  std::vector<ItemPair> folded_pairs_;
  std::vector<char> is_folded_, is_searched_;  // (patches)
  std::vector<SweptBox> triangle_box_;         // (triangles) of the searched patches
  std::vector<char> is_sharp_, is_in_fold_;    // (num_cloth_vertices)
  std::vector<PairChunk> chunks_;
  std::vector<int> begin_of_a_;
  std::vector<FeaturePair> ordered_;
  std::vector<ItemPair>
      one_ring_pairs_;  // triangles that share a vertex at which the cloth forms a sharp tip
};

}  // namespace weft::engine
