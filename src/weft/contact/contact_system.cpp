#include "weft/contact/contact_system.h"

#include <algorithm>
#include <cmath>

#include "weft/geometry/coplanar_time.h"
#include "weft/geometry/distance.h"

namespace weft {
namespace {

constexpr int kPairGrain = 1024;  // pairs per chunk

/// How much stiffer than its inertia, m/h², a contact is in the solve: the higher, the less cloth is pressed
/// in, and the less is left for hold_off to mend. At rest under gravity g h²/1000, 3 µm at 60 steps per
/// second.
constexpr double kShapeStiffness = 1000;
constexpr double kPairStiffness = 300;

/// Cloth found too near to cloth at the start of a step is set apart little by little, by this share of what
/// lacks per step: all at once would throw it.
constexpr double kRecovery = 0.2;

/// Almost parallel edges have no reliable direction between them: sin² of the angle.
constexpr double kParallelSq = 0.03;

/// Edges that pass each other at this share of their length when they are in one plane do meet.
constexpr double kMeeting = 1e-3;

/// Features this near have no direction between them at all [m].
constexpr double kTouching = 1e-9;

/// A triangle counts beside its corners where it comes this much nearer to a shape than they do [m].
constexpr double kNearerThanCorners = 1e-6;

constexpr int kRounds = 8;         // planes of round shapes are taken anew this often
constexpr int kPasses = 8;         // over all constraints between
constexpr int kSearches = 6;       // after friction, contacts are looked for anew this often
constexpr double kSettled = 1e-6;  // corrections below end the rounds [m]

double slack_of(const ClothTopology& topology, double thickness) {
  constexpr double kShareOfEdge = 0.15;
  double sum = 0;
  int count = 0;
  for (const Spring& s : topology.springs) {
    if (s.kind != SpringKind::structural) continue;
    sum += s.rest_length;
    ++count;
  }
  return std::max(thickness, count > 0 ? kShareOfEdge * sum / count : 0.0);
}

/// A ball around the shape; planes have none.
struct Bound {
  Vec3 center = Vec3::Zero();
  double radius = std::numeric_limits<double>::infinity();
};
Bound bound_of(const Sphere& s) { return {s.center, s.radius}; }
Bound bound_of(const Plane&) { return {}; }
Bound bound_of(const Capsule& c) { return {0.5 * (c.a + c.b), 0.5 * (c.b - c.a).norm() + c.radius}; }
Bound bound_of(const OrientedBox& b) { return {b.center, b.half_size.norm()}; }
Bound bound_of(const MeshShape&) { return {}; }

TriangleSignedDistance triangle_distance(const ColliderShape& shape, const Vec3& a, const Vec3& b,
                                         const Vec3& c, double reach = kNoReach) {
  return std::visit(
      [&](const auto& s) -> TriangleSignedDistance {
        if constexpr (std::is_same_v<std::decay_t<decltype(s)>, MeshShape>) {
          return {std::numeric_limits<double>::infinity(), Vec3::UnitX(), Vec3::UnitY()};
        } else {
          return signed_distance(s, a, b, c, reach);
        }
      },
      shape);
}

}  // namespace

// ---- The step ----

Vec3 ContactSystem::MovingShape::velocity_at(const Vec3& p, double step) const {
  if (collider->motion.is_still()) return Vec3::Zero();
  return (p - apply(pose_before, pivot, apply_inverse(pose_after, pivot, p))) / step;
}

void ContactSystem::begin_step(std::span<const ContactCloth> cloths, const std::vector<Collider>& colliders,
                               const ContactStep& step) {
  cloths_.assign(cloths.begin(), cloths.end());
  step_ = step;
  shapes_.clear();
  const double start = step.time - step.step;
  for (const Collider& c : colliders) {
    shapes_.push_back({&c, shape_at(c, start), shape_at(c, step.time), c.motion.at(start),
                       c.motion.at(step.time), weft::pivot(c.shape)});
  }
  renumber(colliders);
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    const ClothModel& model = *cloths_[c].model;
    for (int i = 0, v = first_vertex_[c]; i < model.num_particles(); ++i, ++v) {
      motion_.start[v] = cloths_[c].state->position(i);
      motion_.half_thickness[v] = model.material.thickness / 2;
      inverse_mass_[v] = (*cloths_[c].is_pinned)[i] ? 0.0 : 1 / model.mass[i];
    }
  }
  place_bodies();
}

void ContactSystem::renumber(const std::vector<Collider>& colliders) {
  std::vector<const TriangleMesh*>& meshes = meshes_now_;
  meshes.clear();
  for (const Collider& c : colliders) {
    if (const MeshShape* mesh = std::get_if<MeshShape>(&c.shape)) meshes.push_back(mesh->mesh.get());
  }
  const auto same_cloth = [](const ContactCloth& c, const auto& topology) {
    return c.model->topology == topology;
  };
  const auto same_mesh = [](const TriangleMesh* m, const auto& mesh) { return m == mesh.get(); };
  if (!first_vertex_.empty() &&
      std::equal(cloths_.begin(), cloths_.end(), numbered_cloths_.begin(), numbered_cloths_.end(),
                 same_cloth) &&
      std::equal(meshes.begin(), meshes.end(), numbered_meshes_.begin(), numbered_meshes_.end(), same_mesh)) {
    return;
  }

  numbered_cloths_.clear();
  numbered_meshes_.clear();
  first_vertex_.clear();
  bodies_.clear();
  Surface surface;
  std::vector<Vec3> rest;
  double slack = std::numeric_limits<double>::infinity();
  for (const ContactCloth& cloth : cloths_) {
    const ClothTopology& topology = *cloth.model->topology;
    numbered_cloths_.push_back(cloth.model->topology);
    first_vertex_.push_back(surface.num_vertices);
    surface.add(topology.mesh.triangles, topology.num_particles());
    rest.insert(rest.end(), topology.mesh.positions.begin(), topology.mesh.positions.end());
    slack = std::min(slack, slack_of(topology, cloth.model->material.thickness));
  }
  const int num_cloth_vertices = surface.num_vertices;
  const int num_cloth_triangles = static_cast<int>(surface.triangles.size());
  first_vertex_.push_back(num_cloth_vertices);
  for (int c = 0; c < static_cast<int>(colliders.size()); ++c) {
    const MeshShape* shape = std::get_if<MeshShape>(&colliders[c].shape);
    if (!shape) continue;
    numbered_meshes_.push_back(shape->mesh);
    const std::vector<Edge> edges = build_edges(*shape->mesh);
    const bool is_closed =
        std::all_of(edges.begin(), edges.end(), [](const Edge& e) { return e.num_triangles == 2; });
    bodies_.push_back(
        {c, surface.num_vertices, surface.num_vertices + shape->mesh->num_vertices(), is_closed});
    surface.add(shape->mesh->triangles, shape->mesh->num_vertices());
  }
  surface.build_fans();
  const int n = surface.num_vertices;
  motion_.start.assign(n, Vec3::Zero());
  motion_.end.assign(n, Vec3::Zero());
  motion_.half_thickness.assign(n, 0.0);
  inverse_mass_.assign(n, 0.0);
  velocity_.assign(n, Vec3::Zero());
  slowed_.assign(n, Vec3::Zero());
  is_touched_.assign(n, 0);
  proximity_.reset(std::move(surface), std::move(rest), num_cloth_vertices, num_cloth_triangles, slack);
}

void ContactSystem::place_bodies() {
  for (const Body& body : bodies_) {
    const MovingShape& shape = shapes_[body.collider];
    const MeshShape &before = std::get<MeshShape>(shape.before), &after = std::get<MeshShape>(shape.after);
    for (int v = body.first_vertex; v < body.end_vertex; ++v) {
      const Vec3& p = after.mesh->positions[v - body.first_vertex];
      motion_.start[v] = before.rotation * p + before.translation;
      motion_.end[v] = after.rotation * p + after.translation;
      velocity_[v] = (motion_.end[v] - motion_.start[v]) / step_.step;
    }
  }
}

void ContactSystem::end_of(int cloth) {
  for (int v = first_vertex_[cloth]; v < first_vertex_[cloth + 1]; ++v) {
    motion_.end[v] = cloths_[cloth].state->position(v - first_vertex_[cloth]);
  }
}

void ContactSystem::predict(const Vec3& acceleration, std::span<const Vec3> pin_targets, JobSystem& jobs) {
  const double h = step_.step;
  std::size_t pin = 0;
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    for (int v = first_vertex_[c]; v < first_vertex_[c + 1]; ++v) {
      const int i = v - first_vertex_[c];
      const bool is_pinned = (*cloths_[c].is_pinned)[i];
      motion_.end[v] = is_pinned
                           ? pin_targets[pin++]
                           : Vec3(motion_.start[v] + h * cloths_[c].state->v.get(i) + h * h * acceleration);
    }
  }
  proximity_.update(motion_, jobs);
  constraints_.clear();
  if (proximity_.wildest() >= 0) return;
  collect_shapes(1.0);
  collect_pairs(jobs);
  // What is stopped is met by what comes behind it: pairs are looked for where cloth will more likely be.
  project_positions(inverse_mass_, kPasses, constraints_, motion_.end);
  std::erase_if(constraints_, [](const Constraint& c) { return c.shape < 0; });
  proximity_.update(motion_, jobs);
  collect_pairs(jobs);
}

void ContactSystem::find_contacts(int cloth, std::vector<Contact>& contacts) const {
  contacts.clear();
  const int begin = first_vertex_[cloth], end = first_vertex_[cloth + 1];
  const Vec3& origin = cloths_[cloth].state->origin;
  const double h = step_.step;
  for (const Constraint& c : constraints_) {
    Contact contact;
    contact.num_particles = 0;
    contact.normal = c.normal;
    contact.offset = c.target;
    contact.grip = h * c.surface_velocity;
    contact.friction = c.friction;
    contact.stiffness = (c.shape >= 0 ? kShapeStiffness : kPairStiffness) / (c.inverse_mass * h * h);
    double own_inverse_mass = 0;
    for (int k = 0; k < c.num_vertices; ++k) {
      const int v = c.vertex[k];
      const double w = c.weight[k];
      if (v >= begin && v < end) {
        contact.particle[contact.num_particles] = v - begin;
        contact.weight[contact.num_particles++] = w;
        contact.offset -= w * c.normal.dot(origin);
        contact.grip += w * (motion_.start[v] - origin);
        own_inverse_mass += w * w * inverse_mass_[v];
      } else {
        contact.offset -= w * c.normal.dot(motion_.end[v]);
        contact.grip -= w * (motion_.end[v] - motion_.start[v]);
      }
    }
    if (own_inverse_mass > 0) contacts.push_back(contact);
  }
}

int ContactSystem::wild_cloth() const {
  return proximity_.wildest() < 0 ? -1 : cloth_of(proximity_.wildest());
}

void ContactSystem::hold_off(JobSystem& jobs) {
  proximity_.update(motion_, jobs);
  constraints_.clear();
  if (proximity_.wildest() >= 0) return;
  collect_pairs(jobs);
  collect_shapes(0.0);
  if (constraints_.empty()) return;
  project(jobs);
  store_touched();
}

// ---- Pairs of features ----

void ContactSystem::collect_pairs(JobSystem& jobs) {
  const auto collect = [&](const std::vector<FeaturePair>& pairs, const auto& make) {
    const int count = static_cast<int>(pairs.size());
    const std::size_t num_chunks = (count + kPairGrain - 1) / kPairGrain;
    if (chunks_.size() < num_chunks) chunks_.resize(num_chunks);
    parallel_for(jobs, count, kPairGrain, [&](int begin, int end) {
      std::vector<Constraint>& chunk = chunks_[begin / kPairGrain];
      chunk.clear();
      for (int p = begin; p < end; ++p) {
        Constraint c;
        if (make(p, c)) chunk.push_back(c);
      }
    });
    for (std::size_t k = 0; k < num_chunks; ++k) {
      constraints_.insert(constraints_.end(), chunks_[k].begin(), chunks_[k].end());
    }
  };
  const std::vector<FeaturePair>& vertex_triangle = proximity_.vertex_triangle();
  const std::vector<FeaturePair>& edge_edge = proximity_.edge_edge();
  collect(vertex_triangle, [&](int p, Constraint& c) { return make_vertex_triangle(vertex_triangle[p], c); });
  collect(edge_edge, [&](int p, Constraint& c) { return make_edge_edge(edge_edge[p], c); });
  if (!bodies_.empty())
    collect(vertex_triangle, [&](int p, Constraint& c) { return make_vertex_corner(p, c); });
}

/// A vertex of cloth that is nearest to an edge or a corner of a collider's mesh: ridges have no face under
/// them. The vertex' first pair with a mesh stands for all of them.
bool ContactSystem::make_vertex_corner(int first, Constraint& c) const {
  const std::vector<FeaturePair>& pairs = proximity_.vertex_triangle();
  const std::vector<Vec3>& x = motion_.start;
  const int vertex = pairs[first].a, num_cloth = first_vertex_.back();
  const auto is_body = [&](const FeaturePair& p) {
    return proximity_.surface().triangles[p.b][0] >= num_cloth;
  };
  if (vertex >= num_cloth || !is_body(pairs[first])) return false;
  if (first > 0 && pairs[first - 1].a == vertex && is_body(pairs[first - 1])) return false;
  // Nearest at the start or, for what comes from farther, at the end: what lists hold by chance must not
  // count.
  PointTriangleDistance nearest{0, Vec3::Zero(), TriangleRegion::face};
  const FeaturePair* pair = nullptr;
  for (const std::vector<Vec3>* y : {&motion_.start, &motion_.end}) {
    nearest.distance_sq = std::numeric_limits<double>::infinity();
    for (std::size_t p = first; p < pairs.size() && pairs[p].a == vertex; ++p) {
      const auto [i, j, k] = proximity_.surface().triangles[pairs[p].b];
      const PointTriangleDistance d = point_triangle_distance((*y)[vertex], (*y)[i], (*y)[j], (*y)[k]);
      if (d.distance_sq >= nearest.distance_sq) continue;
      nearest = d;
      pair = &pairs[p];
    }
    if (nearest.distance() <= motion_.half_thickness[vertex]) break;
  }
  if (nearest.region == TriangleRegion::face || nearest.distance() > motion_.half_thickness[vertex])
    return false;
  const auto [i, j, k] = proximity_.surface().triangles[pair->b];
  c.num_vertices = 4;
  c.vertex = {i, j, k, vertex};
  c.weight = {-nearest.weights[0], -nearest.weights[1], -nearest.weights[2], 1};
  const double distance = c.sum(x).norm();
  if (distance < kTouching) return false;
  c.normal = c.sum(x) / distance;
  return finish_pair(distance, gap_of(*pair, c), c);
}

/// At the start only with the foot inside the triangle: towards its border the direction would lie sideways
/// and make cloth sticky. What is beyond is the neighbouring triangles' or the edges' matter.
bool ContactSystem::make_vertex_triangle(const FeaturePair& pair, Constraint& c) const {
  const auto [i, j, k] = proximity_.surface().triangles[pair.b];
  const std::vector<Vec3>& x = motion_.start;
  c.num_vertices = 4;
  c.vertex = {i, j, k, pair.a};
  if (const auto time = find_coplanar_time(places(c, motion_.start), places(c, motion_.end))) {
    const std::array<Vec3, 4> p = places_at(c, *time);
    const PointTriangleDistance d = point_triangle_distance(p[3], p[0], p[1], p[2]);
    if (d.region == TriangleRegion::face) {
      c.weight = {-d.weights[0], -d.weights[1], -d.weights[2], 1};
      c.normal = (p[1] - p[0]).cross(p[2] - p[0]).stableNormalized();
      return finish_crossing(pair, c);
    }
  }
  const PointTriangleDistance d = point_triangle_distance(x[pair.a], x[i], x[j], x[k]);
  if (d.region != TriangleRegion::face) return false;
  c.weight = {-d.weights[0], -d.weights[1], -d.weights[2], 1};
  double distance = d.distance();
  const double gap = gap_of(pair, c);
  const std::vector<Vec3>& y = motion_.end;
  if (!is_close(distance, gap, c,
                [&] { return point_triangle_distance(y[pair.a], y[i], y[j], y[k]).distance(); })) {
    return false;
  }
  if (is_on_closed_body(i)) {
    // The outside is known, so that what is inside by a little is pushed out.
    c.normal = (x[j] - x[i]).cross(x[k] - x[i]).stableNormalized();
    distance = c.normal.dot(c.sum(x));
  } else {
    if (distance < kTouching) return false;
    c.normal = c.sum(x) / distance;
  }
  return finish_pair(distance, gap, c);
}

bool ContactSystem::make_edge_edge(const FeaturePair& pair, Constraint& c) const {
  const auto [i, j] = proximity_.surface().edges[pair.a];
  const auto [k, l] = proximity_.surface().edges[pair.b];
  const std::vector<Vec3>& x = motion_.start;
  c.num_vertices = 4;
  c.vertex = {i, j, k, l};
  const auto is_inside = [](const EdgeEdgeDistance& d) {
    return d.region_a == EdgeRegion::interior && d.region_b == EdgeRegion::interior;
  };
  const auto are_parallel = [](const Vec3& u, const Vec3& v) {
    return u.cross(v).squaredNorm() < kParallelSq * u.squaredNorm() * v.squaredNorm();
  };
  if (const auto time = find_coplanar_time(places(c, motion_.start), places(c, motion_.end))) {
    const std::array<Vec3, 4> p = places_at(c, *time);
    const EdgeEdgeDistance d = edge_edge_distance(p[0], p[1], p[2], p[3]);
    const double meeting = kMeeting * (p[1] - p[0]).norm();
    if (is_inside(d) && d.distance_sq < meeting * meeting && !are_parallel(p[1] - p[0], p[3] - p[2])) {
      c.weight = {1 - d.s, d.s, -(1 - d.t), -d.t};
      c.normal = (p[1] - p[0]).cross(p[3] - p[2]).stableNormalized();
      return finish_crossing(pair, c);
    }
  }
  const EdgeEdgeDistance d = edge_edge_distance(x[i], x[j], x[k], x[l]);
  if (!is_inside(d) || are_parallel(x[j] - x[i], x[l] - x[k])) return false;
  const double distance = d.distance(), gap = gap_of(pair, c);
  if (distance < kTouching) return false;
  const std::vector<Vec3>& y = motion_.end;
  if (!is_close(distance, gap, c, [&] { return edge_edge_distance(y[i], y[j], y[k], y[l]).distance(); }))
    return false;
  c.weight = {1 - d.s, d.s, -(1 - d.t), -d.t};
  c.normal = c.sum(x) / distance;
  return finish_pair(distance, gap, c);
}

std::array<Vec3, 4> ContactSystem::places(const Constraint& c, const std::vector<Vec3>& x) {
  return {x[c.vertex[0]], x[c.vertex[1]], x[c.vertex[2]], x[c.vertex[3]]};
}

std::array<Vec3, 4> ContactSystem::places_at(const Constraint& c, double time) const {
  std::array<Vec3, 4> p = places(c, motion_.start);
  for (int k = 0; k < 4; ++k) p[k] += time * (motion_.end[c.vertex[k]] - p[k]);
  return p;
}

/// The features go through each other during the step: they are to stay on the side where they come from.
bool ContactSystem::finish_crossing(const FeaturePair& pair, Constraint& c) const {
  const Vec3 approach = c.sum(motion_.end) - c.sum(motion_.start);
  if (c.normal.dot(approach) > 0) c.normal = -c.normal;
  return finish_pair(std::max(c.normal.dot(c.sum(motion_.start)), kTouching), gap_of(pair, c), c);
}

/// The pair's thickness, or what neighbours on the mesh may have of it.
double ContactSystem::gap_of(const FeaturePair& pair, const Constraint& c) const {
  const double thickness = motion_.half_thickness[c.vertex[0]] + motion_.half_thickness[c.vertex[3]];
  return std::min(thickness, double{pair.max_gap});
}

/// Whether the pair is close at the start of the step or at its end. Lists hold all such pairs, and others by
/// chance: these must not count. `distance` is that at the start.
template <class Distance>
bool ContactSystem::is_close(double distance, double gap, const Constraint& c,
                             const Distance& distance_at_end) const {
  if (distance <= gap) return true;
  double travel = 0;
  const Vec3 common = motion_.end[c.vertex[0]] - motion_.start[c.vertex[0]];
  for (int k = 1; k < 4; ++k) {
    travel = std::max(travel, (motion_.end[c.vertex[k]] - motion_.start[c.vertex[k]] - common).norm());
  }
  return distance <= gap + 2 * travel && distance_at_end() <= gap;
}

/// False if nothing of the pair can move.
bool ContactSystem::finish_pair(double distance, double gap, Constraint& c) const {
  const int first = c.vertex[0], last = c.vertex[3];
  for (int k = 0; k < 4; ++k) c.inverse_mass += c.weight[k] * c.weight[k] * inverse_mass_[c.vertex[k]];
  if (c.inverse_mass == 0) return false;
  const bool is_body = std::max(first, last) >= first_vertex_.back();
  c.target = distance < gap && !is_body ? distance + kRecovery * (gap - distance) : gap;
  c.friction = is_body ? shapes_[body_of(std::max(first, last)).collider].collider->friction
                       : std::sqrt(friction_of(first) * friction_of(last));
  return true;
}

int ContactSystem::cloth_of(int vertex) const {
  return static_cast<int>(std::upper_bound(first_vertex_.begin(), first_vertex_.end(), vertex) -
                          first_vertex_.begin()) -
         1;
}

double ContactSystem::friction_of(int vertex) const {
  return cloths_[cloth_of(vertex)].model->material.friction;
}

const ContactSystem::Body& ContactSystem::body_of(int vertex) const {
  return *std::find_if(bodies_.begin(), bodies_.end(), [&](const Body& b) { return vertex < b.end_vertex; });
}

bool ContactSystem::is_on_closed_body(int vertex) const {
  return vertex >= first_vertex_.back() && body_of(vertex).is_closed;
}

// ---- Plain shapes ----

void ContactSystem::collect_shapes(double share_of_travel) {
  for (int s = 0; s < static_cast<int>(shapes_.size()); ++s) {
    if (!shapes_[s].is_mesh()) collect_shape(s, share_of_travel);
  }
}

/// Particles nearer than their gap and as much again, and `share_of_travel` of their way in this step; and
/// triangles that are nearer than their corners.
void ContactSystem::collect_shape(int shape, double share_of_travel) {
  const MovingShape& moving = shapes_[shape];
  const Bound bound = std::visit([](const auto& s) { return bound_of(s); }, moving.after);
  const double triangle_reach = proximity_.longest_edge() / std::sqrt(3.0);
  const int num_vertices = first_vertex_.back();
  shape_distance_.resize(num_vertices);
  bool is_any_near = false;
  for (int v = 0; v < num_vertices; ++v) {
    const double reach =
        2 * motion_.half_thickness[v] + share_of_travel * (motion_.end[v] - motion_.start[v]).norm();
    const Vec3& p = motion_.end[v];
    shape_distance_[v] = std::numeric_limits<double>::infinity();
    const double farthest = bound.radius + reach + triangle_reach;
    if ((p - bound.center).squaredNorm() > farthest * farthest) continue;
    shape_distance_[v] = signed_distance(moving.after, p).distance;
    is_any_near = true;
    if (shape_distance_[v] < reach && inverse_mass_[v] > 0) add_shape_constraint(shape, 1, {v, v, v});
  }
  if (!is_any_near || std::holds_alternative<Plane>(moving.after)) return;
  const std::vector<Triangle>& triangles = proximity_.surface().triangles;
  for (const Triangle& t : triangles) {
    if (t[0] >= num_vertices) break;
    const double nearest = std::min({shape_distance_[t[0]], shape_distance_[t[1]], shape_distance_[t[2]]});
    const double travel = share_of_travel * (motion_.end[t[0]] - motion_.start[t[0]]).norm();
    const double reach = 2 * motion_.half_thickness[t[0]] + travel;
    if (nearest > reach + triangle_reach) continue;
    const std::vector<Vec3>& x = motion_.end;
    const double distance = triangle_distance(moving.after, x[t[0]], x[t[1]], x[t[2]], reach).distance;
    if (distance < reach &&
        distance < nearest - std::max(kNearerThanCorners, share_of_travel * motion_.half_thickness[t[0]]))
      add_shape_constraint(shape, 3, t);
  }
}

void ContactSystem::add_shape_constraint(int shape, int num_vertices, const Triangle& vertices) {
  Constraint c;
  c.num_vertices = num_vertices;
  c.vertex = {vertices[0], vertices[1], vertices[2], 0};
  c.shape = shape;
  c.friction = shapes_[shape].collider->friction;
  take_plane(c);
  if (c.inverse_mass > 0) constraints_.push_back(c);
}

ContactSystem::Nearest ContactSystem::find_nearest(const ColliderShape& shape, const Constraint& c,
                                                   const std::vector<Vec3>& x) {
  const Vec3& a = x[c.vertex[0]];
  if (c.num_vertices == 1) {
    const SignedDistance d = signed_distance(shape, a);
    return {d.distance, d.normal, a - d.distance * d.normal, {1, 0, 0, 0}};
  }
  const Vec3 &b = x[c.vertex[1]], &e = x[c.vertex[2]];
  const TriangleSignedDistance d = triangle_distance(shape, a, b, e);
  return {d.distance,
          d.normal,
          point_at(d.weights, a, b, e) - d.distance * d.normal,
          {d.weights[0], d.weights[1], d.weights[2], 0}};
}

/// The plane that touches the shape where the particle or triangle is nearest at the end of the step; unless
/// that lies beyond the shape's middle: then where it was nearest at the start.
void ContactSystem::take_plane(Constraint& c) const {
  const MovingShape& moving = shapes_[c.shape];
  Nearest nearest = find_nearest(moving.after, c, motion_.end);
  if (nearest.distance < 0) {
    const Mat3 turn = moving.pose_after.rotation * moving.pose_before.rotation.transpose();
    const Nearest before = find_nearest(moving.before, c, motion_.start);
    const Vec3 normal_before = turn * before.normal;
    if (before.distance > 0 && nearest.normal.dot(normal_before) <= 0) {
      c.is_fixed = true;
      nearest = before;
      nearest.normal = normal_before;
      nearest.foot = apply(moving.pose_after, moving.pivot,
                           apply_inverse(moving.pose_before, moving.pivot, before.foot));
    }
  }
  c.normal = nearest.normal;
  c.weight = nearest.weight;
  c.target = c.normal.dot(nearest.foot) + motion_.half_thickness[c.vertex[0]];
  c.surface_velocity = moving.velocity_at(nearest.foot, step_.step);
  c.inverse_mass = 0;
  for (int k = 0; k < c.num_vertices; ++k)
    c.inverse_mass += c.weight[k] * c.weight[k] * inverse_mass_[c.vertex[k]];
}

// ---- Setting apart ----

/// Returns the largest correction of the first round [m].
double ContactSystem::settle_positions() {
  double first = 0;
  for (int round = 0; round < kRounds; ++round) {
    const double moved = project_positions(inverse_mass_, kPasses, constraints_, motion_.end);
    if (round == 0) first = moved;
    if (moved < kSettled) break;
    for (Constraint& c : constraints_) {
      if (c.shape < 0 || c.is_fixed || !c.is_active) continue;
      take_plane(c);
      c.push = 0;
    }
  }
  return first;
}

void ContactSystem::project(JobSystem& jobs) {
  settle_positions();
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    for (int v = first_vertex_[c]; v < first_vertex_[c + 1]; ++v) {
      velocity_[v] = cloths_[c].state->v.get(v - first_vertex_[c]);
      slowed_[v].setZero();
    }
  }
  project_velocities(inverse_mass_, constraints_, velocity_, slowed_);
  take_back_slides();
  // What has been moved may have met what was out of its reach.
  for (int search = 0; search < kSearches; ++search) {
    proximity_.update(motion_, jobs);
    constraints_.clear();
    collect_pairs(jobs);
    collect_shapes(0.0);
    const double moved = settle_positions();
    mark_touched();
    if (moved < kSettled) break;
  }
}

/// Friction also takes back the slide of this step, so that what sticks does not creep.
void ContactSystem::take_back_slides() {
  mark_touched();
  for (int v = 0; v < first_vertex_.back(); ++v) {
    if (is_touched_[v]) motion_.end[v] += step_.step * slowed_[v];
  }
}

void ContactSystem::mark_touched() {
  for (const Constraint& c : constraints_) {
    if (!c.is_active) continue;
    for (int k = 0; k < c.num_vertices; ++k) is_touched_[c.vertex[k]] = 1;
  }
}

void ContactSystem::store_touched() {
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    for (int v = first_vertex_[c]; v < first_vertex_[c + 1]; ++v) {
      if (!is_touched_[v] || inverse_mass_[v] == 0) continue;
      cloths_[c].state->set_position(v - first_vertex_[c], motion_.end[v]);
      cloths_[c].state->v.set(v - first_vertex_[c], velocity_[v]);
    }
  }
  std::fill(is_touched_.begin(), is_touched_.end(), char{0});
}

}  // namespace weft
