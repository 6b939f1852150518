#pragma once
/// Which vertices and triangles, and which edges, may come close during a step.

#include <limits>
#include <vector>

#include "weft/contact/surface.h"
#include "weft/core/job_system.h"
#include "weft/geometry/aabb_tree.h"

namespace weft {

/// Where all vertices of the Surface are at the start and at the end of a step, and how much room they want.
struct SurfaceMotion {
  std::vector<Vec3> start, end;        // (num_vertices) [m]
  std::vector<double> half_thickness;  // (num_vertices) two features are close within the sum of theirs [m]
};

/// A vertex and a triangle, or two edges.
struct FeaturePair {
  int a = 0, b = 0;
  float max_gap = std::numeric_limits<float>::infinity();  // neighbours on the mesh may come this close [m]
};

/// Finds close pairs with an AABB tree of moving boxes: what moves together does not meet, however fast it
/// is. A vertex' pairs are kept as long as it moves as it did then, to within `slack`, or so but for a
/// motion that is common to all cloth; else they alone are looked for anew. A list may hold pairs that are
/// not close, never misses one that is, and is in a fixed order.
class Proximity {
 public:
  /// How far vertices may move before pairs are looked for anew: the most where few are near, the least where
  /// many are [m].
  struct Slack {
    double most = 0, least = 0;
  };

  /// The first `num_cloth_triangles` triangles are cloth, the first `num_cloth_vertices` vertices too; the
  /// others are colliders', which are not held against each other. `rest` (num_cloth_vertices) are the cloth
  /// at rest, by which neighbours on the mesh are told from folds [m].
  void reset(Surface surface, std::vector<Vec3> rest, int num_cloth_vertices, int num_cloth_triangles,
             const Slack& slack);

  /// What each triangle belongs to (triangles), and which of these go through each other: `passes` (things,
  /// things) is symmetric; empty: none do. Pairs of those that do are not listed.
  void set_things(std::vector<int> thing_of_triangle) { thing_of_triangle_ = std::move(thing_of_triangle); }
  void let_pass(const std::vector<char>& passes);

  /// Makes the lists hold for this motion. If cloth of many triangles moves against itself by more than its
  /// own size, then all is near to all: the lists are left empty, and wildest() tells a vertex.
  void update(const SurfaceMotion& motion, JobSystem& jobs);

  /// The vertex that moved farthest when the last update gave up, -1 if it did not.
  int wildest() const { return wildest_; }

  const Surface& surface() const { return surface_; }
  const std::vector<FeaturePair>& vertex_triangle() const { return vertex_triangle_; }
  const std::vector<FeaturePair>& edge_edge() const { return edge_edge_; }

  /// No edge of cloth is longer now [m].
  double longest_edge() const { return longest_edge_; }

 private:
  struct PairChunk {
    std::vector<FeaturePair> vertex_triangle, edge_edge;
    PairPart triangles;

    void clear() {
      vertex_triangle.clear();
      edge_edge.clear();
    }
  };

  struct FanShape {
    Eigen::Vector3f normal;
    float height;  // the least of three [m]
  };

  void find_moved(const SurfaceMotion& motion);
  void find_drift(const SurfaceMotion& motion);
  void choose_slack();
  void measure_edges();
  void rebuild(const SurfaceMotion& motion, JobSystem& jobs);
  bool pass(int triangle, int other) const;
  bool renew(const SurfaceMotion& motion, JobSystem& jobs);
  void mark_moved(const SurfaceMotion& motion);
  void drop_pairs_of_moved();
  void make_boxes(JobSystem& jobs);
  MovingAabb box_of_vertex(int vertex) const;
  int find_wildest(const SurfaceMotion& motion) const;
  void fit_tree(AabbTree& tree, int begin, int end, JobSystem& jobs);
  void find_pairs(AabbTree::Extent extent, JobSystem& jobs);
  template <class Add>
  void add_pairs(int count, int grain, const Add& add, JobSystem& jobs);
  void put_in_order(int end_of_a, std::vector<FeaturePair>& pairs);
  void add_pairs_of_triangles(int first, int second, bool is_fan, PairChunk& chunk) const;
  void add_vertex_triangle(int vertex, int triangle, bool is_fan, PairChunk& chunk) const;
  MovingAabb box_of_edge(int edge) const;
  void add_edge_edge(int a, int b, bool is_fan, PairChunk& chunk) const;
  template <class Distance>
  void add_pair(FeaturePair pair, double reach, bool is_fan, const Distance& distance,
                std::vector<FeaturePair>& pairs) const;
  template <std::size_t kA, std::size_t kB>
  double reach_between(const std::array<int, kA>& a, const std::array<int, kB>& b) const;
  void find_fan_shapes(const std::vector<Vec3>& x, std::vector<FanShape>& shapes, JobSystem& jobs);
  bool is_sharp(int vertex, const std::vector<FanShape>& shapes) const;
  void find_fans(JobSystem& jobs);

  Surface surface_;
  std::vector<Vec3> rest_;
  int num_cloth_vertices_ = 0, num_cloth_triangles_ = 0;
  std::vector<int> thing_of_triangle_;
  std::vector<char> passes_;
  std::size_t num_things_ = 0;
  Slack slacks_;
  double slack_ = 0;      // for the next lists [m]
  double made_with_ = 0;  // for those at hand [m]

  AabbTree cloth_tree_, body_tree_;
  SurfaceMotion made_for_;      // what the lists were made for, but for a motion in common; or empty
  Vec3 origin_ = Vec3::Zero();  // of boxes
  std::vector<FeaturePair> vertex_triangle_, edge_edge_;
  double longest_edge_ = 0;  // [m]
  int wildest_ = -1;

  // Of what the lists were made for.
  std::vector<MovingAabb> vertex_box_, triangle_box_;
  std::vector<char> is_sharp_;                           // (num_cloth_vertices)
  std::vector<FanShape> shape_at_start_, shape_at_end_;  // (num_cloth_triangles)

  // What is to be looked for anew.
  std::vector<int> moved_;  // vertices
  Vec3 drift_at_start_ = Vec3::Zero(), drift_at_end_ = Vec3::Zero();
  std::vector<char> is_moved_;    // (num_vertices)
  std::vector<char> is_renewed_;  // (triangles) has one of them
  std::vector<char> is_near_;     // (num_vertices) in one of these triangles

  // Work space.
  std::vector<PairChunk> chunks_;
  std::vector<int> begin_of_a_;
  std::vector<FeaturePair> ordered_;
  std::vector<ItemPair> fans_;  // triangles that share a vertex at which the cloth makes a point
};

}  // namespace weft
