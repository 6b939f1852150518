#include "weft/contact/pair_constraints.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "weft/contact/collect.h"
#include "weft/geometry/coplanar_time.h"
#include "weft/geometry/distance.h"

namespace weft::engine {
namespace {

constexpr int kPairGrain = 1024;  // pairs per chunk

/// Cloth too near to cloth at the start of a step is separated gradually, at most by this share of the missing
/// distance: full separation in one step would throw it. A solve with contacts recovers by this rate, so that
/// parts of a step do not throw it either.
constexpr double kMaxRecovery = 0.2;
constexpr double kRecoveryRate = 12;  // [1/s]

/// Almost parallel edges have no reliable direction between them: limit of sin² of the angle.
constexpr double kParallelSq = 0.03;

/// Edges that come nearer than this when they are coplanar count as meeting [m].
constexpr double kMeeting = 1e-5;

/// The solve includes pairs that are farther apart than their gap by up to this share of it: cloth with a
/// collider, two cloths, and cloth that pushed each other in the last step. A larger share between cloths
/// weakens friction near its limit. A smaller one with colliders misses more contacts of cloth that a moving
/// body carries along, and the step is then solved again.
constexpr double kNearBy = 3, kNearByCloth = 0.07, kNearByPressed = 0.15;

/// Features this near have no direction between them [m].
constexpr double kTouching = 1e-9;

class NarrowPhase {
 public:
  explicit NarrowPhase(const PairInput& in)
      : bodies_(in.bodies),
        numbering_(in.bodies.numbering),
        surface_(*in.bodies.surface),
        motion_(in.bodies.motion),
        lists_(in.lists),
        caught_(in.caught),
        memory_(in.memory),
        purpose_(in.purpose) {}

  // Each returns whether there is a constraint.
  bool make_vertex_corner(int first, Constraint& c) const;
  bool make_vertex_triangle(const FeaturePair& pair, Constraint& c) const;
  bool make_edge_edge(const FeaturePair& pair, Constraint& c) const;

 private:
  bool is_behind(std::span<const int> vertices, const Vec3& direction) const;
  bool starts_behind(const Constraint& c) const;
  static void turn_outwards(double& distance, Constraint& c);
  std::optional<double> find_meeting_time(const Constraint& c, double distance, double travel) const;
  static std::array<Vec3, 4> places(const Constraint& c, const std::vector<Vec3>& x);
  std::array<Vec3, 4> places_at(const Constraint& c, double time) const;
  bool finish_crossing(const FeaturePair& pair, Constraint& c) const;
  double gap_of(const FeaturePair& pair, const Constraint& c) const;
  double near_by(double gap, double share) const;
  double share_nearby(const Constraint& c) const;
  double relative_travel(const Constraint& c) const;
  bool finish_pair(double distance, double gap, Constraint& c) const;

  const StepBodies& bodies_;
  const Numbering& numbering_;
  const Surface& surface_;
  const SurfaceMotion& motion_;
  const Proximity& lists_;
  const CaughtParticles& caught_;
  const ContactMemory& memory_;
  Purpose purpose_;
};

/// A cloth vertex that is nearest to an edge or a corner of a collider mesh, where no face lies below it. The
/// vertex's first pair with a mesh stands for all of them.
bool NarrowPhase::make_vertex_corner(int first, Constraint& c) const {
  const std::vector<FeaturePair>& pairs = lists_.vertex_triangle();
  const std::vector<Vec3>& x = motion_.start;
  const int vertex = pairs[first].a, num_cloth = bodies_.num_cloth_vertices();
  const auto is_body = [&](const FeaturePair& p) { return surface_.triangles[p.b][0] >= num_cloth; };
  if (vertex >= num_cloth || !is_body(pairs[first])) return false;
  if (first > 0 && pairs[first - 1].a == vertex && is_body(pairs[first - 1])) return false;
  // Nearest at the start or, for features that come from farther, at the end. Other pairs in the lists must
  // not affect the result.
  PointTriangleDistance nearest{0, Vec3::Zero(), TriangleRegion::face};
  const FeaturePair* pair = nullptr;
  for (const std::vector<Vec3>* y : {&motion_.start, &motion_.end}) {
    nearest.distance_sq = std::numeric_limits<double>::infinity();
    for (std::size_t p = first; p < pairs.size() && pairs[p].a == vertex; ++p) {
      const auto [i, j, k] = surface_.triangles[pairs[p].b];
      const PointTriangleDistance d = point_triangle_distance((*y)[vertex], (*y)[i], (*y)[j], (*y)[k]);
      if (d.distance_sq >= nearest.distance_sq) continue;
      nearest = d;
      pair = &pairs[p];
    }
    if (nearest.distance() <= near_by(motion_.half_thickness[vertex], kNearBy)) break;
  }
  if (nearest.region == TriangleRegion::face ||
      nearest.distance() > near_by(motion_.half_thickness[vertex], kNearBy))
    return false;
  const auto [i, j, k] = surface_.triangles[pair->b];
  c.num_vertices = 4;
  c.vertex = {i, j, k, vertex};
  c.weight = {-nearest.weights[0], -nearest.weights[1], -nearest.weights[2], 1};
  const double distance = c.sum(x).norm();
  if (distance < kTouching) return false;
  c.normal = c.sum(x) / distance;
  return finish_pair(distance, gap_of(*pair, c), c);
}

/// At the start, only with the foot inside the triangle: near its border the normal would tilt sideways and
/// make cloth stick. The neighbouring triangles or the edges handle points beyond it.
bool NarrowPhase::make_vertex_triangle(const FeaturePair& pair, Constraint& c) const {
  const Triangle& triangle = surface_.triangles[pair.b];
  const int i = triangle[0], j = triangle[1], k = triangle[2];
  const std::vector<Vec3>& x = motion_.start;
  c.num_vertices = 4;
  c.vertex = {i, j, k, pair.a};
  const PointTriangleDistance d = point_triangle_distance(x[pair.a], x[i], x[j], x[k]);
  double distance = d.distance();
  const double gap = gap_of(pair, c), travel = relative_travel(c);
  if (distance > gap + travel) return false;
  if (const auto time = find_meeting_time(c, distance, travel)) {
    const std::array<Vec3, 4> p = places_at(c, *time);
    const PointTriangleDistance there = point_triangle_distance(p[3], p[0], p[1], p[2]);
    if (there.region == TriangleRegion::face) {
      c.weight = {-there.weights[0], -there.weights[1], -there.weights[2], 1};
      c.normal = (p[1] - p[0]).cross(p[2] - p[0]).stableNormalized();
      const bool leaves = numbering_.is_on_solid(i) && c.normal.dot(c.sum(motion_.end) - c.sum(x)) > 0;
      return !leaves && finish_crossing(pair, c);
    }
  }
  if (d.region != TriangleRegion::face) return false;
  c.weight = {-d.weights[0], -d.weights[1], -d.weights[2], 1};
  const std::vector<Vec3>& y = motion_.end;
  const double near = near_by(gap, share_nearby(c));
  if (distance > near && point_triangle_distance(y[pair.a], y[i], y[j], y[k]).distance() > near) return false;
  if (numbering_.is_on_solid(i)) {
    // The outside is defined, so slight penetration is pushed out.
    c.normal = (x[j] - x[i]).cross(x[k] - x[i]).stableNormalized();
    distance = c.normal.dot(c.sum(x));
  } else {
    if (distance < kTouching) return false;
    c.normal = c.sum(x) / distance;
    if (numbering_.is_on_solid(pair.a) && is_behind(std::span(&pair.a, 1), -c.normal))
      turn_outwards(distance, c);
  }
  return finish_pair(distance, gap, c);
}

/// Whether a direction from a corner or an edge of a mesh points behind all faces there.
bool NarrowPhase::is_behind(std::span<const int> vertices, const Vec3& direction) const {
  const std::vector<Vec3>& x = motion_.start;
  bool is = true;
  surface_.for_triangles_with(vertices, [&](int t) {
    const auto [i, j, k] = surface_.triangles[t];
    is = is && (x[j] - x[i]).cross(x[k] - x[i]).dot(direction) < 0;
  });
  return is;
}

/// Cloth that a corner or an edge of a closed mesh has pierced leaves it outwards.
void NarrowPhase::turn_outwards(double& distance, Constraint& c) {
  c.normal = -c.normal;
  distance = -distance;
}

bool NarrowPhase::make_edge_edge(const FeaturePair& pair, Constraint& c) const {
  const std::array<int, 2>&a = surface_.edges[pair.a], &b = surface_.edges[pair.b];
  const int i = a[0], j = a[1], k = b[0], l = b[1];
  const std::vector<Vec3>& x = motion_.start;
  c.num_vertices = 4;
  c.vertex = {i, j, k, l};
  const auto is_inside = [](const EdgeEdgeDistance& d) {
    return d.region_a == EdgeRegion::interior && d.region_b == EdgeRegion::interior;
  };
  const auto are_parallel = [](const Vec3& u, const Vec3& v) {
    return u.cross(v).squaredNorm() < kParallelSq * u.squaredNorm() * v.squaredNorm();
  };
  const EdgeEdgeDistance d = edge_edge_distance(x[i], x[j], x[k], x[l]);
  double distance = d.distance();
  const double gap = gap_of(pair, c), travel = relative_travel(c);
  if (distance > gap + travel) return false;
  if (const auto time = find_meeting_time(c, distance, travel)) {
    const std::array<Vec3, 4> p = places_at(c, *time);
    const EdgeEdgeDistance there = edge_edge_distance(p[0], p[1], p[2], p[3]);
    if (is_inside(there) && there.distance() < kMeeting && !are_parallel(p[1] - p[0], p[3] - p[2])) {
      c.weight = {1 - there.s, there.s, -(1 - there.t), -there.t};
      c.normal = (p[1] - p[0]).cross(p[3] - p[2]).stableNormalized();
      return !starts_behind(c) && finish_crossing(pair, c);
    }
  }
  if (!is_inside(d) || are_parallel(x[j] - x[i], x[l] - x[k])) return false;
  if (distance < kTouching) return false;
  const std::vector<Vec3>& y = motion_.end;
  const double near = near_by(gap, share_nearby(c));
  if (distance > near && edge_edge_distance(y[i], y[j], y[k], y[l]).distance() > near) return false;
  c.weight = {1 - d.s, d.s, -(1 - d.t), -d.t};
  c.normal = c.sum(x) / distance;
  if (starts_behind(c)) turn_outwards(distance, c);
  return finish_pair(distance, gap, c);
}

/// Whether an edge of cloth starts behind both faces at the edge of a closed mesh.
bool NarrowPhase::starts_behind(const Constraint& c) const {
  if (!numbering_.is_on_body(c)) return false;
  const bool is_first = c.vertex[0] >= bodies_.num_cloth_vertices();
  const std::span edge = std::span(c.vertex).subspan(is_first ? 0 : 2, 2);
  const Vec3 between = c.sum(motion_.start);
  return numbering_.is_on_solid(edge[0]) && is_behind(edge, is_first ? Vec3(-between) : between);
}

/// Time of coplanarity, if the four vertices can meet by then: from `distance`, with motion up to `travel`.
std::optional<double> NarrowPhase::find_meeting_time(const Constraint& c, double distance,
                                                     double travel) const {
  if (distance > travel + kMeeting) return std::nullopt;
  return find_coplanar_time(places(c, motion_.start), places(c, motion_.end));
}

std::array<Vec3, 4> NarrowPhase::places(const Constraint& c, const std::vector<Vec3>& x) {
  return {x[c.vertex[0]], x[c.vertex[1]], x[c.vertex[2]], x[c.vertex[3]]};
}

std::array<Vec3, 4> NarrowPhase::places_at(const Constraint& c, double time) const {
  std::array<Vec3, 4> p = places(c, motion_.start);
  for (int k = 0; k < 4; ++k) p[k] += time * (motion_.end[c.vertex[k]] - p[k]);
  return p;
}

/// Features that pass through each other during the step: they stay on the side they come from.
bool NarrowPhase::finish_crossing(const FeaturePair& pair, Constraint& c) const {
  const Vec3 approach = c.sum(motion_.end) - c.sum(motion_.start);
  if (c.normal.dot(approach) > 0) c.normal = -c.normal;
  return finish_pair(std::max(c.normal.dot(c.sum(motion_.start)), kTouching), gap_of(pair, c), c);
}

/// The pair's thickness, or the share of it that mesh neighbours may keep. Cloth pressed into cloth is
/// separated gradually; its depth carries no information, and none is left to it.
double NarrowPhase::gap_of(const FeaturePair& pair, const Constraint& c) const {
  const double thickness = motion_.half_thickness[c.vertex[0]] + motion_.half_thickness[c.vertex[3]];
  return (numbering_.is_on_body(c) ? required_share(purpose_) : 1) *
         std::min(thickness, double{pair.max_gap});
}

/// The distance below which a pair counts. The solve includes cloth that lies on a collider or on other cloth
/// and almost touches it: it would otherwise fall, be separated again, and vibrate.
double NarrowPhase::near_by(double gap, double share) const {
  return (purpose_ == Purpose::solve ? 1 + share : 1) * gap;
}

/// How much farther apart than its gap a pair may be to count for the solve, as a share of the gap. Folds at
/// rest stay in it: they touch at their gap, where inertia predicts as often a little more as a little less.
double NarrowPhase::share_nearby(const Constraint& c) const {
  if (purpose_ != Purpose::solve) return 0;
  if (numbering_.is_on_body(c)) return kNearBy;
  if (memory_.was_pressed(c)) return kNearByPressed;
  return numbering_.cloth_of(c.vertex[0]) != numbering_.cloth_of(c.vertex[3]) ? kNearByCloth : 0;
}

/// Upper bound for the change of the pair's distance during the step [m].
double NarrowPhase::relative_travel(const Constraint& c) const {
  double travel = 0;
  const Vec3 common = motion_.end[c.vertex[0]] - motion_.start[c.vertex[0]];
  for (int k = 1; k < 4; ++k) {
    travel = std::max(travel, (motion_.end[c.vertex[k]] - motion_.start[c.vertex[k]] - common).norm());
  }
  return 2 * travel;
}

/// Returns false if no vertex of the pair can move.
bool NarrowPhase::finish_pair(double distance, double gap, Constraint& c) const {
  const int first = c.vertex[0], last = c.vertex[3];
  c.inverse_mass = c.inverse_mass_of(bodies_.inverse_mass);
  if (c.inverse_mass == 0 || caught_.replaces(c)) return false;
  const bool is_body = numbering_.is_on_body(c);
  const double recovery =
      purpose_ == Purpose::projection ? kMaxRecovery : std::min(kMaxRecovery, kRecoveryRate * bodies_.step);
  c.target = distance < gap && !is_body ? distance + recovery * (gap - distance) : gap;
  const BodyPlace cloth = numbering_.place_of(std::min(first, last)),
                  other = numbering_.place_of(std::max(first, last));
  c.friction = bodies_.friction_of(bodies_.pairs.of(cloth, other), c);
  return true;
}

}  // namespace

void generate_pair_constraints(const PairInput& input, JobSystem& jobs,
                               std::vector<std::vector<Constraint>>& chunks,
                               std::vector<Constraint>& constraints) {
  const NarrowPhase narrow_phase(input);
  const auto generate = [&](const std::vector<FeaturePair>& pairs, const auto& make) {
    collect_in_order(
        jobs, static_cast<int>(pairs.size()), kPairGrain, chunks,
        [&](int p, std::vector<Constraint>& chunk) {
          Constraint c;
          if (make(p, c)) chunk.push_back(c);
        },
        [&](const std::vector<Constraint>& chunk) {
          constraints.insert(constraints.end(), chunk.begin(), chunk.end());
        });
  };
  const std::vector<FeaturePair>& vertex_triangle = input.lists.vertex_triangle();
  const std::vector<FeaturePair>& edge_edge = input.lists.edge_edge();
  generate(vertex_triangle,
           [&](int p, Constraint& c) { return narrow_phase.make_vertex_triangle(vertex_triangle[p], c); });
  generate(edge_edge, [&](int p, Constraint& c) { return narrow_phase.make_edge_edge(edge_edge[p], c); });
  if (!input.bodies.numbering.bodies.empty())
    generate(vertex_triangle, [&](int p, Constraint& c) { return narrow_phase.make_vertex_corner(p, c); });
}

}  // namespace weft::engine
