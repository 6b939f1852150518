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

/// Finds close pairs with an AABB tree, and keeps them as long as nothing has moved farther than `slack`:
/// most steps only look whether that still holds. All is seen from a frame that moves with the cloth on the
/// average, so that free fall keeps its pairs. A list may hold pairs that are not close, never misses one
/// that is, and is in a fixed order.
class Proximity {
 public:
  /// The first `num_cloth_triangles` triangles are cloth, the first `num_cloth_vertices` vertices too; the
  /// others are colliders', which are not held against each other. `rest` (num_cloth_vertices) are the cloth
  /// at rest, by which neighbours on the mesh are told from folds [m].
  void reset(Surface surface, std::vector<Vec3> rest, int num_cloth_vertices, int num_cloth_triangles,
             double slack);

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
  bool still_holds(const SurfaceMotion& motion);
  void measure_edges(const SurfaceMotion& motion);
  void rebuild(const SurfaceMotion& motion, JobSystem& jobs);
  void box_vertices(const SurfaceMotion& motion);
  int find_wildest(const SurfaceMotion& motion) const;
  void fit_tree(AabbTree& tree, int begin, int end, JobSystem& jobs);
  void add_pairs_of_triangles(const SurfaceMotion& motion, const ItemPair& pair, bool is_fan);
  void add_vertex_triangle(const SurfaceMotion& motion, int vertex, int triangle, bool is_fan);
  void add_edge_edge(const SurfaceMotion& motion, int a, int b, bool is_fan);
  template <class Distance>
  void add_pair(const SurfaceMotion& motion, FeaturePair pair, double reach, bool is_fan,
                const Distance& distance, std::vector<FeaturePair>& pairs);
  double reach_between(const SurfaceMotion& motion, int v, int w) const;
  void mark_sharp(const std::vector<Vec3>& x);
  void add_fans(const SurfaceMotion& motion);
  Aabb box_of_triangle(int triangle) const;

  struct FanShape {
    Vec3 normal;
    double height;  // the least of three [m]
  };

  Surface surface_;
  std::vector<Vec3> rest_;
  int num_cloth_vertices_ = 0, num_cloth_triangles_ = 0;
  double slack_ = 0;

  AabbTree cloth_tree_, body_tree_;
  std::vector<Vec3> reference_;         // (num_vertices) where the lists were made, empty if there are none
  std::vector<double> half_thickness_;  // (num_vertices) for which they were made [m]
  std::vector<FeaturePair> vertex_triangle_, edge_edge_;
  double longest_edge_ = 0;  // [m]
  int wildest_ = -1;

  // Work space of rebuild().
  Vec3 drift_ = Vec3::Zero();
  std::vector<Aabb> vertex_box_;
  std::vector<double> travel_;  // of each vertex during the step, against the common motion [m]
  PairSearch search_;
  std::vector<char> is_sharp_;       // (num_cloth_vertices)
  std::vector<FanShape> fan_shape_;  // (num_cloth_triangles)
};

}  // namespace weft
