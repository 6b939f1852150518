#pragma once
/// The pairs of features that can have met while surfaces moved.

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
  std::array<int, 2> feature = {0, 0};  // of `surface`: a vertex, twice, or an edge's two
  std::array<int, 2> opposite = {0, 0};  // of `other`: a triangle, twice, an edge's two vertices, or −1 twice

  auto operator<=>(const FeaturePair&) const = default;
};

/// A surface that moves in straight lines from one moment to the next.
struct MovingSurface {
  enum class Kind { cloth, body, frame };  // a frame is a body of which only vertices and edges count

  MovingSurface(std::vector<Triangle> of, Kind kind);

  std::vector<Triangle> triangles;  // with a corner twice: an edge; three times: a vertex
  bool is_cloth = true, has_faces = true;
  std::vector<Vec3> start, end;      // of the vertices [m]
  std::vector<unsigned char> owned;  // (triangles) bits 0–2: its corners, 3–5: the edges that follow them;
                                     // each vertex and edge belongs to the first triangle that has it
};

/// Verlet lists: pairs of features by the distance that they had once. Each surface's motion since is bounded
/// by its mean motion and the farthest that a vertex has strayed from that; two surfaces' pairs that were
/// farther apart than they have moved relative to each other cannot have met. Where surfaces have moved
/// farther than the lists reach, all pairs whose boxes overlap during the motion are found again.
class FeaturePairs {
 public:
  /// `reach`: lists hold pairs that are as near as this [m].
  FeaturePairs(int num_surfaces, double reach);

  /// The boxes in which vertices move, in floats: rounding never changes the order of two numbers, so it
  /// hides no overlap.
  using Box = Eigen::AlignedBox3f;
  using Boxes = std::vector<std::vector<Box>>;  // (surfaces) of (vertices)

  using Visit = std::function<void(const FeaturePair&)>;
  using MayMeet = std::function<bool(int, int)>;

  /// Calls visit once for every vertex and triangle, and every two edges, that can have met in this motion:
  /// of surfaces that may meet, without a vertex in common. To be called for each motion in turn. Of cloth
  /// that has been flung about, by more than its own size against itself, everything may have met everything:
  /// then no pair is visited, and the answer is false.
  bool for_each(const std::vector<MovingSurface>& surfaces, const MayMeet& may_meet, const Visit& visit);

 private:
  struct Near {
    double distance;  // when the list was made [m]
    FeaturePair pair;
  };

  struct Group {
    bool is_due = false;     // no list reaches as far as they have moved
    double way = 0;          // relative to each other in this motion, at most [m]
    double moved = 0;        // relative to each other since the list was made, at most [m]
    double reach = 0;        // the list is complete up to this distance [m]
    std::vector<Near> near;  // by distance
  };

  Group& group(int a, int b) { return groups_[std::min(a, b) * num_surfaces_ + std::max(a, b)]; }
  void rebuild(const std::vector<MovingSurface>& surfaces, const Visit& visit);
  std::vector<Sweep::Box> boxes_of_triangles(const std::vector<MovingSurface>& surfaces, const Boxes& boxes);
  void reach_across_gaps(const std::vector<MovingSurface>& surfaces);

  int num_surfaces_;
  double reach_;
  std::vector<Group> groups_;  // of two surfaces
};

}  // namespace weft::engine::verify
