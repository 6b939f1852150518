#pragma once
/// Feature pairs that can have met during a motion of surfaces.

#include <algorithm>
#include <array>
#include <compare>
#include <functional>
#include <vector>

#include "weft/mesh/triangle_mesh.h"
#include "weft/verify/sweep.h"

namespace weft::engine::verify {

struct FeaturePair {
  enum class Kind { vertex_triangle, edge_edge, particle_shape };

  Kind kind = Kind::vertex_triangle;
  int surface = 0, other = 0;
  std::array<int, 2> feature = {0, 0};  // of `surface`: a vertex, twice, or an edge's two vertices
  std::array<int, 2> opposite = {0, 0};  // of `other`: a triangle, twice, an edge's two vertices, or −1 twice

  auto operator<=>(const FeaturePair&) const = default;
};

/// A surface in linear motion between two frames.
struct MovingSurface {
  enum class Kind { cloth, body, frame };  // frame: a body without faces; only vertices and edges count

  MovingSurface(std::vector<Triangle> of, Kind kind);

  std::vector<Triangle> triangles;  // with a corner twice: an edge; three times: a vertex
  bool is_cloth = true, has_faces = true;
  std::vector<Vec3> start, end;      // of the vertices [m]
  std::vector<unsigned char> owned;  // (triangles) bits 0–2: its corners, 3–5: the edges that follow them;
                                     // each vertex and edge belongs to the first triangle that has it
};

/// Verlet lists: feature pairs with their distance when listed. Each surface's motion since then is bounded
/// by its mean motion and the largest deviation of a vertex from it. Pairs of two surfaces that were farther
/// apart than their relative motion cannot have met. If surfaces have moved farther than the lists reach, all
/// pairs with overlapping swept boxes are found again.
class FeaturePairs {
 public:
  /// `reach`: lists contain pairs up to this distance [m].
  FeaturePairs(int num_surfaces, double reach);

  /// Swept boxes of vertices, in floats: rounding never changes the order of two numbers, so it hides no
  /// overlap.
  using Box = Eigen::AlignedBox3f;
  using Boxes = std::vector<std::vector<Box>>;  // (surfaces) of (vertices)

  using Visit = std::function<void(const FeaturePair&)>;
  using MayMeet = std::function<bool(int, int)>;

  /// Calls visit once for every vertex–triangle and edge–edge pair that can have met in this motion, on
  /// surfaces that may meet, without common vertices. Call for each motion in sequence. If cloth moves
  /// relative to itself by more than its own size, every pair may have met: then no pair is visited, and the
  /// result is false.
  bool for_each(const std::vector<MovingSurface>& surfaces, const MayMeet& may_meet, const Visit& visit);

 private:
  struct Near {
    double distance;  // when listed [m]
    FeaturePair pair;
  };

  struct Group {
    bool is_due = false;     // the list is too short for the motion
    double way = 0;          // bound of the relative displacement in this motion [m]
    double moved = 0;        // bound of the relative displacement since the list was made [m]
    double reach = 0;        // the list is complete up to this distance [m]
    std::vector<Near> near;  // by distance
  };

  Group& group(int a, int b) { return groups_[std::min(a, b) * num_surfaces_ + std::max(a, b)]; }
  void rebuild(const std::vector<MovingSurface>& surfaces, const Visit& visit);
  std::vector<Sweep::Box> boxes_of_triangles(const std::vector<MovingSurface>& surfaces, const Boxes& boxes);
  void reach_across_gaps(const std::vector<MovingSurface>& surfaces);

  int num_surfaces_;
  double reach_;
  std::vector<Group> groups_;  // one per two surfaces
};

}  // namespace weft::engine::verify
