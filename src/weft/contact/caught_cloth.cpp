#include "weft/contact/caught_cloth.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "weft/contact/between.h"

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

/// A feature of cloth that touches a collider.
struct Touch {
  HoldingSide side;
  Vec3 normal, point;  // towards the cloth; at the start [m]
  std::array<int, 3> vertices = {};
  int num_vertices = 0;
};

class Catcher {
 public:
  Catcher(const StepBodies& bodies, CaughtParticles& caught) : bodies_(bodies), caught_(caught) {}

  void recall();
  bool find(std::span<const Constraint> constraints);

 private:
  bool is_caught(const Between& between, const std::array<HoldingSide, 2>& sides, int vertex,
                 bool is_pulled) const;
  bool place_caught(Caught& caught) const;
  bool are_present(const std::array<HoldingSide, 2>& sides) const;
  std::optional<Touch> touch_of(const Constraint& c) const;
  bool can_hold(const HoldingSide& first, const HoldingSide& second) const;
  bool has_long_edge(int vertex, double stretch, bool only_caught) const;
  bool has_long_edge(const Touch& touch, double stretch, bool only_caught) const;
  bool find_face(const Vec3& direction, const Touch& touch, HoldingSide& side) const;
  void catch_between(const Touch& first, const Touch& second);

  const StepBodies& bodies_;
  CaughtParticles& caught_;
};

void Catcher::recall() {
  for (int c = 0; c < bodies_.num_cloths(); ++c) {
    for (const CaughtParticle& p : bodies_.cloths[c].state->caught) {
      Caught caught{.vertex = bodies_.numbering.first_vertex[c] + p.particle, .sides = p.sides};
      if (bodies_.inverse_mass[caught.vertex] > 0 && are_present(p.sides) && place_caught(caught))
        caught_.add(caught);
    }
  }
}

bool Catcher::find(std::span<const Constraint> constraints) {
  std::vector<Touch> touches;
  std::vector<std::pair<int, int>> touched;  // vertices, and indices into touches
  for (const Constraint& c : constraints) {
    const std::optional<Touch> touch = touch_of(c);
    if (!touch) continue;
    for (int k = 0; k < touch->num_vertices; ++k)
      touched.emplace_back(touch->vertices[k], static_cast<int>(touches.size()));
    touches.push_back(*touch);
  }
  std::sort(touched.begin(), touched.end());
  const std::size_t before = caught_.all().size();
  for (bool is_growing = true; is_growing;) {
    const std::size_t known = caught_.all().size();
    for (std::size_t n = 0; n < touched.size(); ++n) {
      const Touch& first = touches[touched[n].second];
      for (std::size_t m = n + 1; m < touched.size() && touched[m].first == touched[n].first; ++m) {
        const Touch& second = touches[touched[m].second];
        if (first.normal.dot(second.normal) <= kStillFacing && can_hold(first.side, second.side))
          catch_between(first, second);
      }
    }
    is_growing = caught_.all().size() > known;
  }
  return caught_.all().size() > before;
}

/// Whether the surfaces leave cloth no room that it could reach. It was between them at the start, not where they are
/// now by moving along each other. Cloth that caught cloth pulls need not reach any: pushed out of the wedge
/// between the surfaces step by step, it would be torn off.
bool Catcher::is_caught(const Between& b, const std::array<HoldingSide, 2>& sides, int vertex,
                        bool is_pulled) const {
  const double half_thickness = bodies_.motion.half_thickness[vertex], missing = b.missing(half_thickness);
  // From deep behind a surface, cloth is on another side of the same solid.
  if (std::min(b.before[0].distance, b.before[1].distance) < -2 * half_thickness) return false;
  if (missing < (is_pulled ? kPressedWherePulled : kPressed) * half_thickness) return false;
  const double most = is_pulled ? kStillFacing : kFacing;
  if (b.after[0].normal.dot(b.after[1].normal) > most || cosine_at_start(bodies_, b, sides) > most)
    return false;
  // Along the bisector of the normals, the distance to the outside grows as the surfaces become parallel.
  const double sine = 0.5 * (b.after[0].normal + b.after[1].normal).norm();
  const double near = std::max(2 * half_thickness, kReach * bodies_.numbering.rest_edges_at(vertex).mean) +
                      kShareOfTravel * (b.ways[0] - b.ways[1]).norm();
  return is_pulled || missing > sine * near;
}

/// Finds the planes that hold a caught particle. Returns false if it is free.
///
/// Surfaces that face each other hold it in the middle, or where there is room between them. If one of them is
/// gone, the particle leaves the other by the side from which it came. Where they no longer face each other, it
/// is left alone.
bool Catcher::place_caught(Caught& caught) const {
  const double half_thickness = bodies_.motion.half_thickness[caught.vertex];
  const double room = 2 * half_thickness + kFree * bodies_.numbering.rest_edges_at(caught.vertex).longest;
  const Between b = look_between(bodies_, caught.sides, bodies_.motion.start[caught.vertex]);
  const bool are_facing = b.after[0].normal.dot(b.after[1].normal) <= kStillFacing;
  const auto is_gone = [&](int s) {
    return is_beside(bodies_, caught.sides[s], b.end, room) || (!are_facing && b.before[s].distance > 0);
  };
  const auto plane = [&](int s, const Vec3& normal, double distance) {
    const SignedDistance& d = b.after[s];
    const double reachable = std::max(d.distance, b.before[s].distance) + kLeavingSpeed * bodies_.step;
    const double way = (std::min(distance, reachable) - d.distance) / normal.dot(d.normal);
    return Caught::Plane{normal, normal.dot(b.end) + way, b.ways[s] / bodies_.step};
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

/// Whether the colliders that hold a particle, and their faces, are still there.
bool Catcher::are_present(const std::array<HoldingSide, 2>& sides) const {
  return std::all_of(sides.begin(), sides.end(), [&](const HoldingSide& side) {
    if (side.collider >= static_cast<int>(bodies_.shapes.size())) return false;
    const ColliderShape& shape = bodies_.shapes[side.collider].after;
    const auto* mesh = std::get_if<MeshShape>(&shape);
    const int num_faces = mesh                                         ? mesh->mesh->num_triangles()
                          : std::holds_alternative<OrientedBox>(shape) ? 6
                                                                       : 0;
    return side.face < num_faces && (side.face >= 0) == (num_faces > 0);
  });
}

/// Where a constraint touches cloth, and the surface of a collider there.
std::optional<Touch> Catcher::touch_of(const Constraint& c) const {
  if (c.is_caught || (c.shape < 0 && !bodies_.numbering.is_on_body(c))) return {};
  Touch touch{.side = {.collider = c.shape}, .point = Vec3::Zero()};
  int of_body = -1;
  double sign = 1;  // of the cloth's weights
  for (int k = 0; k < c.num_vertices; ++k) {
    if (c.vertex[k] >= bodies_.num_cloth_vertices()) {
      of_body = c.vertex[k];
      continue;
    }
    if (c.weight[k] == 0) continue;
    if (c.weight[k] < 0) sign = -1;
    touch.vertices[touch.num_vertices++] = c.vertex[k];
    touch.point += std::abs(c.weight[k]) * bodies_.motion.start[c.vertex[k]];
  }
  touch.normal = sign * c.normal;
  if (c.shape >= 0) return touch;
  const ColliderMesh& body = bodies_.numbering.body_of(of_body);
  const int triangle = bodies_.surface->triangles_at(of_body)[0];
  const auto [i, j, k] = bodies_.surface->triangles[triangle];
  const std::vector<Vec3>& x = bodies_.motion.end;
  touch.side = {.collider = body.collider,
                .face = triangle - body.first_triangle,
                .is_back = !body.has_inside_at(i) && (x[j] - x[i]).cross(x[k] - x[i]).dot(touch.normal) < 0};
  return touch;
}

/// Whether cloth fits between two surfaces: a convex shape has none.
bool Catcher::can_hold(const HoldingSide& first, const HoldingSide& second) const {
  return first.collider != second.collider || bodies_.shapes[first.collider].is_mesh();
}

/// Whether an edge at the vertex is longer than at rest by more than the factor `stretch`; only_caught: one that
/// leads to a caught vertex.
bool Catcher::has_long_edge(int vertex, double stretch, bool only_caught) const {
  const int cloth = bodies_.numbering.cloth_of(vertex), first = bodies_.numbering.first_vertex[cloth];
  const RestMesh& mesh = bodies_.cloths[cloth].model->topology->mesh;
  const std::vector<Vec3>& x = bodies_.motion.start;
  const std::span<const int> triangles = bodies_.surface->triangles_at(vertex);
  return std::any_of(triangles.begin(), triangles.end(), [&](int t) {
    const Triangle& corners = bodies_.surface->triangles[t];
    const int own = bodies_.numbering.place_of_triangle(*bodies_.surface, t).index;
    return std::any_of(corners.begin(), corners.end(), [&](int v) {
      return v != vertex && (!only_caught || caught_.has(v)) &&
             (x[v] - x[vertex]).norm() > stretch * mesh.between(own, vertex - first, v - first).norm();
    });
  });
}

/// The same for any vertex of a touch.
bool Catcher::has_long_edge(const Touch& touch, double stretch, bool only_caught) const {
  return std::any_of(touch.vertices.begin(), touch.vertices.begin() + touch.num_vertices,
                     [&](int v) { return has_long_edge(v, stretch, only_caught); });
}

/// For a box, finds the face at a touch that looks most along a direction. Returns false if there is none.
bool Catcher::find_face(const Vec3& direction, const Touch& touch, HoldingSide& side) const {
  const OrientedBox* box = std::get_if<OrientedBox>(&bodies_.shapes[side.collider].before);
  if (box)
    side.face =
        face_along(*box, direction, touch.point, 2 * bodies_.motion.half_thickness[touch.vertices[0]]);
  return !box || side.face >= 0;
}

/// Catches the particles of two touches if there is no room at either.
void Catcher::catch_between(const Touch& first, const Touch& second) {
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
    const Between between = look_between(bodies_, sides, touch->point);
    if (!is_caught(between, sides, touch->vertices[0], is_pulled)) continue;
    for (int k = 0; k < touch->num_vertices; ++k) {
      Caught caught{.vertex = touch->vertices[k], .sides = sides};
      if (bodies_.inverse_mass[caught.vertex] > 0 && place_caught(caught)) caught_.add(caught);
    }
  }
}

}  // namespace

void recall_caught(const StepBodies& bodies, CaughtParticles& caught) { Catcher(bodies, caught).recall(); }

bool find_caught(const StepBodies& bodies, std::span<const Constraint> constraints, CaughtParticles& caught) {
  const bool is_convex = bodies.numbering.bodies.empty() && bodies.shapes.size() < 2;
  return !is_convex && Catcher(bodies, caught).find(constraints);  // one convex shape holds nothing
}

void add_caught_constraints(const StepBodies& bodies, const CaughtParticles& caught,
                            std::vector<Constraint>& constraints) {
  for (const Caught& p : caught.all()) {
    for (int s = 0; s < 2; ++s) {
      const std::optional<Caught::Plane>& plane = p.planes[s];
      if (!plane) continue;
      Constraint c;
      c.vertex = {p.vertex, p.vertex, p.vertex, 0};
      c.shape = p.sides[s].collider;
      c.is_fixed = c.is_caught = true;
      c.normal = plane->normal;
      c.target = plane->target;
      c.surface_velocity = plane->velocity;
      c.inverse_mass = bodies.inverse_mass[p.vertex];
      const PairSettings& settings =
          bodies.pairs.of(bodies.numbering.place_of(p.vertex), {.collider = c.shape});
      c.friction = bodies.friction_of(settings, c);
      constraints.push_back(c);
    }
  }
}

std::vector<Infeasible> store_caught(const StepBodies& bodies, const CaughtParticles& caught) {
  std::vector<Infeasible> is_new;
  const auto is_before = [](const CaughtParticle& a, const CaughtParticle& b) {
    return a.particle < b.particle;
  };
  for (int c = 0; c < bodies.num_cloths(); ++c) {
    const int first = bodies.numbering.first_vertex[c], end = bodies.numbering.first_vertex[c + 1];
    std::vector<CaughtParticle>& known = bodies.cloths[c].state->caught;
    std::vector<CaughtParticle> now;
    for (const Caught& p : caught.all()) {
      if (p.vertex >= first && p.vertex < end) now.push_back({p.vertex - first, p.sides});
    }
    std::sort(now.begin(), now.end(), is_before);
    for (const CaughtParticle& p : now) {
      if (std::binary_search(known.begin(), known.end(), p, is_before)) continue;
      for (const HoldingSide& side : p.sides)
        is_new.push_back({.vertex = first + p.particle, .other = -1, .shape = side.collider});
    }
    known = std::move(now);
  }
  return is_new;
}

}  // namespace weft::engine
