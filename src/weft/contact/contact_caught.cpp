/// ContactSystem's cloth that is caught between colliders (see caught_particles.h).

#include <algorithm>
#include <cmath>

#include "weft/contact/contact_system.h"
#include "weft/geometry/distance.h"

namespace weft::engine {
namespace {

/// Between two surfaces that face each other, cloth is caught if, to be outside of both, it would have to move
/// farther than its thickness or this share of its mean edge, and than this share of their relative motion.
constexpr double kReach = 0.3, kShareOfTravel = 0.25;

/// A longer edge to a caught particle pulls at the other end: its length, over that at rest [1].
constexpr double kPulled = 1.05;

/// Cloth that is only pressed is not caught: up to this share of its thickness is missing; of cloth that caught
/// cloth pulls [1].
constexpr double kPressed = 0.7, kPressedWherePulled = 0.6;

/// A caught particle is free when the surfaces leave as much room more than its thickness, as a share of the
/// cloth's longest edge: then they no longer reach into triangles and edges beside the particle.
constexpr double kFree = 0.1;

/// A caught particle may be away from the middle by this many thicknesses, so that layers have room [1].
constexpr double kMaxPlay = 2;

/// Parts of one body that touch each other, as an arm and the trunk, mostly leave cloth a way out. Between them it is
/// caught if an edge is longer than at rest by this factor [1].
constexpr double kTorn = 2;

/// Speed, relative to a body, at which a particle leaves it when what held it there is gone [m/s].
constexpr double kLeavingSpeed = 1;

/// Surfaces with a larger cosine between their normals do not hold cloth between each other …
constexpr double kFacing = -0.5;
/// … and no longer hold, or hold cloth beside caught cloth, beyond this one.
constexpr double kStillFacing = 0.5;

/// From the plane of a box's face.
SignedDistance distance_from_face(const OrientedBox& box, int face, const Vec3& p) {
  const int axis = face / 2;
  const Vec3 normal = (face % 2 == 0 ? 1.0 : -1.0) * box.rotation.col(axis);
  return {normal.dot(p - box.center) - box.half_size[axis], normal};
}

/// The face of a box that looks most along a direction, of those that p is in front of, or behind by up to `depth`.
int face_along(const OrientedBox& box, const Vec3& direction, const Vec3& p, double depth) {
  int best = -1;
  double most = 0;
  for (int face = 0; face < 6; ++face) {
    const SignedDistance d = distance_from_face(box, face, p);
    if (d.distance < -depth || (best >= 0 && d.normal.dot(direction) <= most)) continue;
    best = face;
    most = d.normal.dot(direction);
  }
  return best;
}

SignedDistance distance_from_shape(const ColliderShape& shape, int face, const Vec3& p) {
  if (const OrientedBox* box = std::get_if<OrientedBox>(&shape)) return distance_from_face(*box, face, p);
  return signed_distance(shape, p);
}

}  // namespace

/// The point of a triangle of a collider that is nearest to p, among the vertex positions x.
ContactSystem::SurfacePoint ContactSystem::point_on(int triangle, const Vec3& p,
                                                    const std::vector<Vec3>& x) const {
  const auto [i, j, k] = surface().triangles[triangle];
  const PointTriangleDistance d = point_triangle_distance(p, x[i], x[j], x[k]);
  return {triangle, d.weights, point_at(d.weights, x[i], x[j], x[k]), d.distance_sq};
}

/// The same on the surface around a triangle: from neighbour to neighbour, as long as the next is nearer. So a
/// side keeps to its own part of the surface, although others come nearer.
ContactSystem::SurfacePoint ContactSystem::walk(HoldingSide& side, const Vec3& p,
                                                const std::vector<Vec3>& x) const {
  const int first = body_with(side.collider).first_triangle;
  SurfacePoint best = point_on(first + side.face, p, x);
  for (bool is_nearer = true; is_nearer;) {
    is_nearer = false;
    for (const int v : surface().triangles[best.triangle]) {
      for (const int t : surface().triangles_at(v)) {
        const SurfacePoint next = point_on(t, p, x);
        if (!(next.distance_sq < best.distance_sq)) continue;
        best = next;
        is_nearer = true;
      }
    }
  }
  side.face = best.triangle - first;
  return best;
}

const ContactSystem::Body& ContactSystem::body_with(int collider) const {
  return *std::find_if(bodies_.begin(), bodies_.end(),
                       [&](const Body& body) { return body.collider == collider; });
}

/// The signed distance from a point of the side's surface to p.
SignedDistance ContactSystem::signed_distance_to(const SurfacePoint& foot, const HoldingSide& side,
                                                 const Vec3& p, const std::vector<Vec3>& x) const {
  const auto [i, j, k] = surface().triangles[foot.triangle];
  Vec3 normal = (x[j] - x[i]).cross(x[k] - x[i]).stableNormalized();
  if (side.is_back) normal = -normal;
  const Vec3 between = p - foot.point;
  const double distance = between.norm(), sign = between.dot(normal) < 0 ? -1 : 1;
  constexpr double kOnIt = 1e-9;  // [m]
  return {sign * distance, distance > kOnIt ? Vec3(sign / distance * between) : normal};
}

/// From the surface at the start of the step to p; also the motion in the step of the point nearest to p [m].
SignedDistance ContactSystem::distance_at_start(HoldingSide& side, const Vec3& p, Vec3& way) const {
  const MovingShape& shape = shapes_[side.collider];
  if (!shape.is_mesh()) {
    const SignedDistance d = distance_from_shape(shape.before, side.face, p);
    const Vec3 foot = p - d.distance * d.normal;
    way = shape.at_end(foot) - foot;
    return d;
  }
  const SurfacePoint foot = walk(side, p, motion_.start);
  const auto [i, j, k] = surface().triangles[foot.triangle];
  way = point_at(foot.weights, motion_.end[i], motion_.end[j], motion_.end[k]) - foot.point;
  return signed_distance_to(foot, side, p, motion_.start);
}

/// From the surface at the end of the step to p.
SignedDistance ContactSystem::distance_at_end(HoldingSide& side, const Vec3& p) const {
  const MovingShape& shape = shapes_[side.collider];
  if (!shape.is_mesh()) return distance_from_shape(shape.after, side.face, p);
  return signed_distance_to(walk(side, p, motion_.end), side, p, motion_.end);
}

ContactSystem::Between ContactSystem::look_between(std::array<HoldingSide, 2>& sides,
                                                   const Vec3& start) const {
  Between b{.start = start};
  for (int s = 0; s < 2; ++s) b.before[s] = distance_at_start(sides[s], start, b.ways[s]);
  b.end = start + 0.5 * (b.ways[0] + b.ways[1]);
  for (int s = 0; s < 2; ++s) b.after[s] = distance_at_end(sides[s], b.end);
  return b;
}

/// Between the normals of the surfaces at the start; beside a box's face that of the box there.
double ContactSystem::cosine_at_start(const Between& b, const std::array<HoldingSide, 2>& sides) const {
  std::array<Vec3, 2> normals;
  for (int s = 0; s < 2; ++s) {
    const ColliderShape& shape = shapes_[sides[s].collider].before;
    normals[s] = std::holds_alternative<OrientedBox>(shape) ? signed_distance(shape, b.start).normal
                                                            : b.before[s].normal;
  }
  return normals[0].dot(normals[1]);
}

/// Whether the surfaces leave cloth no room that it could reach. It was between them at the start, not where they are
/// now by moving along each other. Cloth that caught cloth pulls need not reach any: pushed out of the wedge
/// between the surfaces step by step, it would be torn off.
bool ContactSystem::is_caught(const Between& b, const std::array<HoldingSide, 2>& sides, int vertex,
                              bool is_pulled) const {
  const double half_thickness = motion_.half_thickness[vertex], missing = b.missing(half_thickness);
  // From deep behind a surface, cloth is on another side of the same solid.
  if (std::min(b.before[0].distance, b.before[1].distance) < -2 * half_thickness) return false;
  if (missing < (is_pulled ? kPressedWherePulled : kPressed) * half_thickness) return false;
  const double most = is_pulled ? kStillFacing : kFacing;
  if (b.after[0].normal.dot(b.after[1].normal) > most || cosine_at_start(b, sides) > most) return false;
  // Along the bisector of the normals, the distance to the outside grows as the surfaces become parallel.
  const double sine = 0.5 * (b.after[0].normal + b.after[1].normal).norm();
  const double near =
      std::max(2 * half_thickness, kReach * rest_edges_[mesh_of(first_vertex_, vertex)].mean) +
      kShareOfTravel * (b.ways[0] - b.ways[1]).norm();
  return is_pulled || missing > sine * near;
}

/// Finds the planes that hold a caught particle. Returns false if it is free.
///
/// Surfaces that face each other hold it in the middle, or where there is room between them. If one of them is
/// gone, the particle leaves the other by the side from which it came. Where they no longer face each other, it
/// is left alone.
bool ContactSystem::place_caught(Caught& caught) const {
  const double half_thickness = motion_.half_thickness[caught.vertex];
  const double room = 2 * half_thickness + kFree * rest_edges_[mesh_of(first_vertex_, caught.vertex)].longest;
  const Between b = look_between(caught.sides, motion_.start[caught.vertex]);
  const bool are_facing = b.after[0].normal.dot(b.after[1].normal) <= kStillFacing;
  const auto is_gone = [&](int s) {
    return is_beside(caught.sides[s], b.end, room) || (!are_facing && b.before[s].distance > 0);
  };
  const auto plane = [&](int s, const Vec3& normal, double distance) {
    const SignedDistance& d = b.after[s];
    const double reachable = std::max(d.distance, b.before[s].distance) + kLeavingSpeed * step_.step;
    const double way = (std::min(distance, reachable) - d.distance) / normal.dot(d.normal);
    return Caught::Plane{normal, normal.dot(b.end) + way, b.ways[s] / step_.step};
  };
  caught.planes = {};
  const bool first_is_gone = is_gone(0), second_is_gone = is_gone(1);
  if (first_is_gone || second_is_gone) {
    const int s = first_is_gone ? 1 : 0;
    if ((first_is_gone && second_is_gone) || b.before[s].distance > 0) return false;
    caught.planes[s] = plane(s, b.after[s].normal, half_thickness);
    return true;
  }
  if (!are_facing) return true;
  const double missing = b.missing(half_thickness);
  if (-missing > room && b.before[0].distance > 0 && b.before[1].distance > 0) return false;
  const double play = std::min(missing, kMaxPlay * 2 * half_thickness);
  const double distance = half_thickness - (missing > 0 ? missing + play : 0);
  const Vec3 axis = (b.after[0].normal - b.after[1].normal).normalized();
  caught.planes = {plane(0, axis, distance), plane(1, -axis, distance)};
  return true;
}

/// Whether p is beside a box, by more than `room` from it: the planes of its faces have no end.
bool ContactSystem::is_beside(const HoldingSide& side, const Vec3& p, double room) const {
  const OrientedBox* box = std::get_if<OrientedBox>(&shapes_[side.collider].after);
  return box && distance_from_face(*box, side.face, p).distance < room &&
         signed_distance(*box, p).distance > room;
}

/// Takes over from the states the particles that are still caught.
void ContactSystem::update_caught() {
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    for (const CaughtParticle& p : cloths_[c].state->caught) {
      Caught caught{.vertex = first_vertex_[c] + p.particle, .sides = p.sides};
      if (inverse_mass_[caught.vertex] > 0 && are_present(p.sides) && place_caught(caught))
        caught_.add(caught);
    }
  }
}

/// Whether the colliders that hold a particle, and their faces, are still there.
bool ContactSystem::are_present(const std::array<HoldingSide, 2>& sides) const {
  return std::all_of(sides.begin(), sides.end(), [&](const HoldingSide& side) {
    if (side.collider >= static_cast<int>(shapes_.size())) return false;
    const ColliderShape& shape = shapes_[side.collider].after;
    const auto* mesh = std::get_if<MeshShape>(&shape);
    const int num_faces = mesh                                         ? mesh->mesh->num_triangles()
                          : std::holds_alternative<OrientedBox>(shape) ? 6
                                                                       : 0;
    return side.face < num_faces && (side.face >= 0) == (num_faces > 0);
  });
}

/// Where a constraint touches cloth, and the surface of a collider there.
std::optional<ContactSystem::Touch> ContactSystem::touch_of(const Constraint& c) const {
  if (c.is_caught || (c.shape < 0 && !is_on_body(c))) return {};
  Touch touch{.side = {.collider = c.shape}, .point = Vec3::Zero()};
  int of_body = -1;
  double sign = 1;  // of the cloth's weights
  for (int k = 0; k < c.num_vertices; ++k) {
    if (c.vertex[k] >= first_vertex_.back()) {
      of_body = c.vertex[k];
      continue;
    }
    if (c.weight[k] == 0) continue;
    if (c.weight[k] < 0) sign = -1;
    touch.vertices[touch.num_vertices++] = c.vertex[k];
    touch.point += std::abs(c.weight[k]) * motion_.start[c.vertex[k]];
  }
  touch.normal = sign * c.normal;
  if (c.shape >= 0) return touch;
  const Body& body = body_of(of_body);
  const int triangle = surface().triangles_at(of_body)[0];
  const auto [i, j, k] = surface().triangles[triangle];
  const std::vector<Vec3>& x = motion_.end;
  touch.side = {.collider = body.collider,
                .face = triangle - body.first_triangle,
                .is_back = !body.is_closed && (x[j] - x[i]).cross(x[k] - x[i]).dot(touch.normal) < 0};
  return touch;
}

/// Finds cloth that is caught from this step on, where its constraints with colliders oppose each other.
void ContactSystem::find_caught() {
  if (bodies_.empty() && shapes_.size() < 2) return;  // one convex shape holds nothing
  touches_.clear();
  touched_.clear();
  for (const Constraint& c : constraints_) {
    const std::optional<Touch> touch = touch_of(c);
    if (!touch) continue;
    for (int k = 0; k < touch->num_vertices; ++k)
      touched_.emplace_back(touch->vertices[k], static_cast<int>(touches_.size()));
    touches_.push_back(*touch);
  }
  std::sort(touched_.begin(), touched_.end());
  const std::size_t before = caught_.all().size();
  for (bool is_growing = true; is_growing;) {
    const std::size_t known = caught_.all().size();
    for (std::size_t n = 0; n < touched_.size(); ++n) {
      const Touch& first = touches_[touched_[n].second];
      for (std::size_t m = n + 1; m < touched_.size() && touched_[m].first == touched_[n].first; ++m) {
        const Touch& second = touches_[touched_[m].second];
        if (first.normal.dot(second.normal) <= kStillFacing && can_hold(first.side, second.side))
          catch_between(first, second);
      }
    }
    is_growing = caught_.all().size() > known;
  }
  if (caught_.all().size() == before) return;
  std::erase_if(constraints_, [&](const Constraint& c) { return c.is_caught || is_between(c); });
  add_caught_constraints();
}

/// Whether cloth fits between two surfaces: a convex shape has none.
bool ContactSystem::can_hold(const HoldingSide& first, const HoldingSide& second) const {
  return first.collider != second.collider || shapes_[first.collider].is_mesh();
}

/// Whether an edge at the vertex is longer than at rest by more than the factor `stretch`; only_caught: one that
/// leads to a caught vertex.
bool ContactSystem::has_long_edge(int vertex, double stretch, bool only_caught) const {
  const int cloth = mesh_of(first_vertex_, vertex), first = first_vertex_[cloth];
  const std::vector<Vec3>& rest = cloths_[cloth].model->topology->mesh.positions;
  const std::vector<Vec3>& x = motion_.start;
  const std::span<const int> triangles = surface().triangles_at(vertex);
  return std::any_of(triangles.begin(), triangles.end(), [&](int t) {
    const Triangle& corners = surface().triangles[t];
    return std::any_of(corners.begin(), corners.end(), [&](int v) {
      return v != vertex && (!only_caught || caught_.has(v)) &&
             (x[v] - x[vertex]).norm() > stretch * (rest[v - first] - rest[vertex - first]).norm();
    });
  });
}

/// The same for any vertex of a touch.
bool ContactSystem::has_long_edge(const Touch& touch, double stretch, bool only_caught) const {
  return std::any_of(touch.vertices.begin(), touch.vertices.begin() + touch.num_vertices,
                     [&](int v) { return has_long_edge(v, stretch, only_caught); });
}

/// For a box, finds the face at a touch that looks most along a direction. Returns false if there is none.
bool ContactSystem::find_face(const Vec3& direction, const Touch& touch, HoldingSide& side) const {
  const OrientedBox* box = std::get_if<OrientedBox>(&shapes_[side.collider].before);
  if (box)
    side.face = face_along(*box, direction, touch.point, 2 * motion_.half_thickness[touch.vertices[0]]);
  return !box || side.face >= 0;
}

/// Catches the particles of two touches if there is no room at either.
void ContactSystem::catch_between(const Touch& first, const Touch& second) {
  const auto is_known = [&](const Touch& t) {
    return std::all_of(t.vertices.begin(), t.vertices.begin() + t.num_vertices,
                       [&](int v) { return caught_.has(v); });
  };
  if (is_known(first) && is_known(second)) return;
  for (const Touch* touch : {&first, &second}) {
    const Vec3 across = first.normal - second.normal;
    std::array<HoldingSide, 2> sides = {first.side, second.side};
    if (!find_face(across, first, sides[0]) || !find_face(-across, second, sides[1])) continue;
    const bool is_pulled = !caught_.empty() && has_long_edge(*touch, kPulled, true);
    const bool is_one_body = first.side.collider == second.side.collider;
    if (is_one_body && !is_pulled && !has_long_edge(*touch, kTorn, false)) continue;
    const Between between = look_between(sides, touch->point);
    if (!is_caught(between, sides, touch->vertices[0], is_pulled)) continue;
    for (int k = 0; k < touch->num_vertices; ++k) {
      Caught caught{.vertex = touch->vertices[k], .sides = sides};
      if (inverse_mass_[caught.vertex] > 0 && place_caught(caught)) caught_.add(caught);
    }
  }
}

/// Whether the constraint is replaced: one of its vertices is caught by its collider.
bool ContactSystem::is_between(const Constraint& c) const {
  return caught_.includes(std::span(c.vertex).first(c.num_vertices), c.shape);
}

void ContactSystem::add_caught_constraints() {
  for (const Caught& caught : caught_.all()) {
    for (int s = 0; s < 2; ++s) {
      const std::optional<Caught::Plane>& plane = caught.planes[s];
      if (!plane) continue;
      Constraint c;
      c.vertex = {caught.vertex, caught.vertex, caught.vertex, 0};
      c.shape = caught.sides[s].collider;
      c.is_fixed = c.is_caught = true;
      c.normal = plane->normal;
      c.target = plane->target;
      c.surface_velocity = plane->velocity;
      c.inverse_mass = inverse_mass_[caught.vertex];
      set_friction(pair_settings_[pair_index(place_of(caught.vertex), {.collider = c.shape})], c);
      constraints_.push_back(c);
    }
  }
}

/// Stores the caught particles in the states, and those that are new.
void ContactSystem::store_caught() {
  newly_caught_.clear();
  const auto is_before = [](const CaughtParticle& a, const CaughtParticle& b) {
    return a.particle < b.particle;
  };
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    std::vector<CaughtParticle>& known = cloths_[c].state->caught;
    std::vector<CaughtParticle> now;
    for (const Caught& caught : caught_.all()) {
      if (mesh_of(first_vertex_, caught.vertex) == static_cast<int>(c))
        now.push_back({caught.vertex - first_vertex_[c], caught.sides});
    }
    std::sort(now.begin(), now.end(), is_before);
    for (const CaughtParticle& p : now) {
      if (std::binary_search(known.begin(), known.end(), p, is_before)) continue;
      for (const HoldingSide& side : p.sides)
        newly_caught_.push_back(
            {.vertex = first_vertex_[c] + p.particle, .other = -1, .shape = side.collider});
    }
    known = std::move(now);
  }
}

}  // namespace weft::engine
