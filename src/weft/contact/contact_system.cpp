#include "weft/contact/contact_system.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "weft/mesh/solid.h"

namespace weft::engine {
namespace {

/// Contact stiffness in the solve, relative to the inertia m/h². A higher value lets cloth penetrate less and
/// leaves less to the contact projection. Penetration at rest under gravity is g h²/1000, 3 µm at 60 steps
/// per second.
constexpr double kShapeStiffness = 1000;
constexpr double kPairStiffness = 300;

/// A force that is known before the solve, as that of gas or one that lasts, presses features together by this
/// share of their gap.
constexpr double kPressed = 0.1;

/// Contacts that slide farther than this share of a mean edge in a step have no use for the forces of earlier ones.
constexpr double kFarSlide = 0.5;

/// Penetration that the solve leaves at a collider, below this share of the gap, is kept: a contact's depth
/// is its force, and the next step's friction starts from it.
constexpr double kPressedIn = 0.2;

constexpr int kRounds = 8;            // updates of the planes of round shapes
constexpr int kPasses = 8;            // over all constraints, per round
constexpr int kRoundsAfterSolve = 2;  // the same after a solve with contacts: little is left to do
constexpr int kPassesAfterSolve = 4;
constexpr double kSlidingSpeed = 0.01;  // below, static friction applies [m/s]
constexpr int kSearches = 6;            // maximum of repeated contact searches after friction
constexpr double kSettled = 1e-6;       // corrections below end the rounds [m]

/// Verlet slack, how far cloth may move before pairs are searched again: a share of its cells or thickness.
Proximity::Slack slack_of(const ClothTopology& topology, double thickness) {
  constexpr double kSlackPerEdge = 0.07, kNarrow = 0.3;
  double sum = 0;
  int count = 0;
  for (const Spring& s : topology.springs) {
    if (s.kind != SpringKind::structural) continue;
    sum += s.rest_length;
    ++count;
  }
  const double edge = count > 0 ? sum / count : 0.0;
  return {std::max(thickness, kSlackPerEdge * edge), thickness / 4, std::max(2 * thickness, kNarrow * edge)};
}

/// The part of the acceleration that the particle followed in the last step: from none, where it hung or lay,
/// to all. Supported particles are thus not predicted to fall.
Vec3 felt_acceleration(const ClothState& state, int particle, const Vec3& acceleration) {
  const MotionHistory& history = state.history;
  const double size_sq = acceleration.squaredNorm();
  if (history.step == 0 || size_sq == 0) return acceleration;
  const Vec3 gained = (state.v.get(particle) - history.velocity.get(particle)) / history.step;
  return std::clamp(gained.dot(acceleration) / size_sq, 0.0, 1.0) * acceleration;
}

}  // namespace

void ContactSystem::begin_step(std::span<const ContactCloth> cloths, const std::vector<Collider>& colliders,
                               const ContactStep& step) {
  cloths_.assign(cloths.begin(), cloths.end());
  step_ = step;
  is_predicted_ = is_for_solve_ = false;
  pressed_in_ = 0;
  contact_forces_.clear();
  caught_.clear();
  shapes_.clear();
  const double start = step.time - step.step;
  for (const Collider& c : colliders) {
    shapes_.push_back({&c, shape_at(c, start), shape_at(c, step.time), c.motion.at(start),
                       c.motion.at(step.time), weft::engine::pivot(c.shape)});
  }
  proximity_.measure(step.clock);
  renumber(colliders);
  is_placed_ = is_surveyed_ = is_clear_ = false;
  thickest_ = 0;
  thinnest_ = std::numeric_limits<double>::infinity();
  has_pressure_ =
      std::any_of(cloths.begin(), cloths.end(), [](const ContactCloth& c) { return c.pressure > 0; });
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    starts_[c] = cloths_[c].state->x;
    const double half_thickness = cloths_[c].model->material.thickness / 2;
    thickest_ = std::max(thickest_, half_thickness);
    thinnest_ = std::min(thinnest_, half_thickness);
  }
  if (!may_survey()) place();
}

/// Stores the start of the step, as the contact search requires it.
void ContactSystem::place() {
  is_placed_ = true;
  double travel_sq = 0;  // since the last step with a contact search
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    const ClothModel& model = *cloths_[c].model;
    const Vec3& origin = cloths_[c].state->origin;
    for (int i = 0, v = first_vertex_[c]; i < model.num_particles(); ++i, ++v) {
      const Vec3 start = origin + starts_[c].get(i);
      travel_sq = farther_sq(travel_sq, start - motion_.start[v]);
      motion_.start[v] = start;
      motion_.half_thickness[v] = model.material.thickness / 2;
      inverse_mass_[v] = (*cloths_[c].is_pinned)[i] ? 0.0 : 1 / model.mass[i];
    }
  }
  const double unknown = std::numeric_limits<double>::infinity();
  clearance_.begin_step(shapes_, first_vertex_.back(), is_clearance_known_ ? std::sqrt(travel_sq) : unknown);
  is_clearance_known_ = true;
  place_bodies();
  set_pair_settings();
  store_velocities();
  if (is_predicted_) recall_forces();
  update_caught();
}

void ContactSystem::recall_forces() {
  memory_.begin_step(first_vertex_.back());
  for (std::size_t c = 0; c < cloths_.size(); ++c) memory_.read(first_vertex_[c], *cloths_[c].state);
}

/// Default friction: for two cloths the geometric mean of both, for a cloth and a collider the collider's.
void ContactSystem::set_pair_settings() {
  const int num_cloths = static_cast<int>(cloths_.size()), num_shapes = static_cast<int>(shapes_.size());
  pair_settings_.resize(num_cloths * (num_cloths + num_shapes));
  const auto own = [&](int cloth) { return cloths_[cloth].model->material.friction; };
  for (int c = 0; c < num_cloths; ++c) {
    for (int d = 0; d < num_cloths; ++d)
      pair_settings_[pair_index({.cloth = c}, {.cloth = d})] = {.friction = std::sqrt(own(c) * own(d))};
    for (int s = 0; s < num_shapes; ++s) {
      const Collider& collider = *shapes_[s].collider;
      pair_settings_[pair_index({.cloth = c}, {.collider = s})] = {collider.friction,
                                                                   collider.static_friction};
    }
  }
  for (const ContactRule& rule : step_.rules) {
    const Place cloth{.cloth = rule.cloth}, other{.cloth = rule.other_cloth, .collider = rule.collider};
    PairSettings& settings = pair_settings_[pair_index(cloth, other)];
    settings = {rule.friction.value_or(settings.friction),
                rule.static_friction.value_or(settings.static_friction), rule.collide};
    if (rule.other_cloth >= 0) pair_settings_[pair_index(other, cloth)] = settings;
  }
  set_non_colliding();
}

/// Bodies are the cloths, followed by all colliders.
void ContactSystem::set_non_colliding() {
  non_colliding_.clear();
  if (std::all_of(pair_settings_.begin(), pair_settings_.end(),
                  [](const PairSettings& settings) { return settings.collide; }))
    return proximity_.set_non_colliding(non_colliding_);
  const int num_cloths = static_cast<int>(cloths_.size()),
            num_bodies = num_cloths + static_cast<int>(shapes_.size());
  non_colliding_.assign(num_bodies * num_bodies, 0);
  for (int c = 0; c < num_cloths; ++c) {
    for (int t = 0; t < num_bodies; ++t)
      non_colliding_[c * num_bodies + t] = non_colliding_[t * num_bodies + c] =
          !pair_settings_[c * num_bodies + t].collide;
  }
  proximity_.set_non_colliding(non_colliding_);
}

/// Index into pair_settings_ of a cloth and another cloth or collider.
std::size_t ContactSystem::pair_index(const Place& cloth, const Place& other) const {
  const std::size_t num_cloths = cloths_.size();
  return cloth.cloth * (num_cloths + shapes_.size()) +
         (other.cloth >= 0 ? other.cloth : num_cloths + other.collider);
}

/// Applies the static coefficient if the two were not sliding at the start of the step.
void ContactSystem::set_friction(const PairSettings& settings, Constraint& c) const {
  c.friction = settings.friction;
  if (settings.static_friction <= settings.friction) return;
  Vec3 slide = -c.surface_velocity;
  for (int k = 0; k < c.num_vertices; ++k) slide += c.weight[k] * velocity_before_[c.vertex[k]];
  slide -= slide.dot(c.normal) * c.normal;
  if (slide.norm() < kSlidingSpeed) c.friction = settings.static_friction;
}

/// Stores velocities at the start of the step, for a mesh collider the mean over the step; only where static
/// friction is set.
void ContactSystem::store_velocities() {
  velocity_before_.clear();
  const auto has_static = [](const PairSettings& settings) {
    return settings.static_friction > settings.friction;
  };
  if (std::none_of(pair_settings_.begin(), pair_settings_.end(), has_static)) return;
  for (const ContactCloth& cloth : cloths_) {
    for (int i = 0; i < cloth.model->num_particles(); ++i) velocity_before_.push_back(cloth.state->v.get(i));
  }
  for (std::size_t v = velocity_before_.size(); v < motion_.start.size(); ++v)
    velocity_before_.push_back(velocity_[v].to_vec3());
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
  closed_meshes_.clear();
  Surface surface;
  std::vector<Vec3> rest;
  std::vector<int> body_of_triangle;    // (triangles)
  std::vector<int> collider_of_vertex;  // (vertices of meshes)
  std::vector<Grid> grids;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Proximity::Slack slack{kInfinity, kInfinity, 0};
  for (const ContactCloth& cloth : cloths_) {
    const ClothTopology& topology = *cloth.model->topology;
    numbered_cloths_.push_back(cloth.model->topology);
    first_vertex_.push_back(surface.num_vertices);
    surface.add(topology.mesh.triangles, topology.num_particles());
    body_of_triangle.resize(surface.triangles.size(), static_cast<int>(first_vertex_.size()) - 1);
    rest.insert(rest.end(), topology.mesh.positions.begin(), topology.mesh.positions.end());
    if (topology.grid) grids.push_back(*topology.grid);
    const Proximity::Slack own = slack_of(topology, cloth.model->material.thickness);
    slack = {std::min(slack.most, own.most), std::min(slack.least, own.least),
             std::max(slack.narrow, own.narrow)};
  }
  const int num_cloth_vertices = surface.num_vertices;
  const int num_cloth_triangles = static_cast<int>(surface.triangles.size());
  first_vertex_.push_back(num_cloth_vertices);
  for (int c = 0; c < static_cast<int>(colliders.size()); ++c) {
    const MeshShape* shape = std::get_if<MeshShape>(&colliders[c].shape);
    if (!shape) continue;
    numbered_meshes_.push_back(shape->mesh);
    bodies_.push_back({c, surface.num_vertices, surface.num_vertices + shape->mesh->num_vertices(),
                       static_cast<int>(surface.triangles.size()),
                       is_closed(count_surface_edges(*shape->mesh))});
    collider_of_vertex.resize(collider_of_vertex.size() + shape->mesh->num_vertices(), c);
    Body& body = bodies_.back();
    body.min = body.max = shape->mesh->positions[0];
    for (const Vec3& p : shape->mesh->positions) {
      body.min = body.min.cwiseMin(p);
      body.max = body.max.cwiseMax(p);
    }
    const int first_triangle = static_cast<int>(surface.triangles.size());
    surface.add(shape->mesh->triangles, shape->mesh->num_vertices());
    if (body.is_closed) {
      closed_meshes_.push_back(
          {body.first_vertex, body.end_vertex, first_triangle, static_cast<int>(surface.triangles.size())});
    }
    body_of_triangle.resize(surface.triangles.size(), static_cast<int>(cloths_.size()) + c);
  }
  surface.build_one_rings();
  const Patches patches = build_patches(surface, rest);
  measure_edges(surface, rest);
  const int n = surface.num_vertices;
  motion_.start.assign(n, Vec3::Zero());
  motion_.end.assign(n, Vec3::Zero());
  motion_.half_thickness.assign(n, 0.0);
  inverse_mass_.assign(n, 0.0);
  velocity_.assign(n, {});
  slowed_.assign(n, {});
  near_.reserve(n);
  near_shape_.reserve(num_cloth_vertices);
  is_touched_.assign(n, 0);
  proximity_.reset(std::move(surface), patches, std::move(rest), num_cloth_vertices, num_cloth_triangles,
                   slack);
  proximity_.set_bodies(std::move(body_of_triangle));
  caught_.reset(num_cloth_vertices, std::move(collider_of_vertex));
  has_grids_ = grids.size() == cloths_.size();
  cloth_clearance_.reset(grids);
  starts_.resize(cloths_.size());
  ends_.resize(cloths_.size());
  motions_.resize(cloths_.size());
  is_clearance_known_ = false;
}

/// Mean and longest edges at rest, of each cloth and of all.
void ContactSystem::measure_edges(const Surface& surface, const std::vector<Vec3>& rest) {
  rest_edges_.assign(cloths_.size(), {});
  std::vector<int> count(cloths_.size(), 0);
  for (const auto& [i, j] : surface.edges) {
    if (i >= first_vertex_.back()) break;
    const int cloth = mesh_of(first_vertex_, i);
    const double length = (rest[j] - rest[i]).norm();
    rest_edges_[cloth].longest = std::max(rest_edges_[cloth].longest, length);
    rest_edges_[cloth].mean += length;
    ++count[cloth];
  }
  longest_rest_edge_ = 0;
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    rest_edges_[c].mean /= std::max(count[c], 1);
    longest_rest_edge_ = std::max(longest_rest_edge_, rest_edges_[c].longest);
  }
}

Patches ContactSystem::build_patches(const Surface& surface, const std::vector<Vec3>& rest) const {
  Patches patches;
  int triangle = 0;
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    const ClothTopology& topology = *cloths_[c].model->topology;
    const int end = triangle + topology.mesh.num_triangles();
    if (topology.grid)
      patches.add_grid(surface, *topology.grid, first_vertex_[c], triangle);
    else
      patches.add_mesh(surface, rest, triangle, end);
    triangle = end;
  }
  patches.add_body(surface, triangle, static_cast<int>(surface.triangles.size()));
  return patches;
}

void ContactSystem::place_bodies() {
  for (const Body& body : bodies_) {
    const MovingShape& shape = shapes_[body.collider];
    const MeshShape &before = std::get<MeshShape>(shape.before), &after = std::get<MeshShape>(shape.after);
    for (int v = body.first_vertex; v < body.end_vertex; ++v) {
      motion_.start[v] = before.vertex(v - body.first_vertex);
      motion_.end[v] = after.vertex(v - body.first_vertex);
      velocity_[v] = to_quad((motion_.end[v] - motion_.start[v]) / step_.step);
    }
  }
}

void ContactSystem::read_ends() {
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    for (int i = 0, v = first_vertex_[c]; v < first_vertex_[c + 1]; ++i, ++v)
      motion_.end[v] = cloths_[c].state->position(i);
  }
}

void ContactSystem::read_solution(std::span<const Contact> contacts) {
  if (is_placed_) read_ends();
  contact_forces_.clear();
  memory_.restart();
  is_solved_.assign(cloths_.size(), is_predicted_);
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    const Contact& c = contacts[n];
    for (const int v : {c.particle[0], c.particle[c.num_particles - 1]})
      is_solved_[mesh_of(first_vertex_, v)] = c.is_solved;
    add_contact_force(solved_for_[n], c.force);
    memory_.add(solved_for_[n], c.push);
    if (step_.clock && c.has_pushed) ++step_.clock->times.active;
  }
}

void ContactSystem::predict(const Vec3& acceleration, std::span<const Vec3> pin_targets, JobSystem& jobs) {
  is_predicted_ = is_for_solve_ = true;
  if (is_placed_) {
    recall_forces();
  } else {
    constraints_.clear();
    expected_.clear();
    survey_expected(acceleration, pin_targets);
    if (is_clear_) return;
    place();
  }
  find_candidates(acceleration, pin_targets, jobs);
  expected_.assign(motion_.end.begin(), motion_.end.begin() + first_vertex_.back());
}

void ContactSystem::find_candidates(const Vec3& acceleration, std::span<const Vec3> pin_targets,
                                    JobSystem& jobs) {
  expect_motion(acceleration, pin_targets);
  update_lists(jobs);
  constraints_.clear();
  if (proximity_.diverged_vertex() >= 0) return;
  // Cloth on a shape is predicted to fall into it, and the solve lifts it out; cloth on cloth stays in place.
  std::swap(motion_.end, ballistic_);
  generate_shape_constraints(1.0, step_.step * step_.step * acceleration.norm());
  std::swap(motion_.end, ballistic_);
  generate_pair_constraints(jobs);
  if (constraints_.empty()) return;
  find_caught();
  // Cloth that is stopped far from its predicted end is hit by the cloth behind it: search pairs at the more
  // likely positions.
  arrived_ = motion_.end;
  {
    const WorkScope scope(step_.clock, &WorkTimes::projection);
    project_positions(inverse_mass_, kPassesAfterSolve, constraints_, motion_.end, near_);
  }
  mark_touched();
  const bool is_far = has_left_reach();
  std::fill(is_touched_.begin(), is_touched_.end(), char{0});
  if (!is_far) return;
  std::erase_if(constraints_, [](const Constraint& c) { return c.shape < 0; });
  proximity_.update(motion_, jobs);
  generate_pair_constraints(jobs);
}

/// Predicts motion_.end with the acceleration that acted in the last step, ballistic_ with all of it.
void ContactSystem::expect_motion(const Vec3& acceleration, std::span<const Vec3> pin_targets) {
  const double h = step_.step;
  ballistic_ = motion_.end;
  std::size_t pin = 0;
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    const ClothState& state = *cloths_[c].state;
    for (int i = 0, v = first_vertex_[c]; v < first_vertex_[c + 1]; ++i, ++v) {
      if ((*cloths_[c].is_pinned)[i]) {
        motion_.end[v] = ballistic_[v] = pin_targets[pin++];
        continue;
      }
      const Vec3 inertial = motion_.start[v] + h * state.v.get(i);
      motion_.end[v] = inertial + h * h * felt_acceleration(state, i, acceleration);
      ballistic_[v] = inertial + h * h * acceleration;
    }
  }
}

/// The regular distance between a constraint's features [m].
double ContactSystem::kept_gap(const Constraint& c) const {
  if (c.shape >= 0) return clearance_of(c);
  return motion_.half_thickness[c.vertex[0]] + motion_.half_thickness[c.vertex[3]];
}

/// For contacts that carry the pressure of gas on the particles around them [N/m].
double ContactSystem::pressure_stiffness(const Constraint& c) const {
  double force = 0;
  for (int k = 0; k < c.num_vertices; ++k) {
    const int v = c.vertex[k];
    if (v >= first_vertex_.back()) continue;
    const int cloth = mesh_of(first_vertex_, v);
    const double pressure = cloths_[cloth].pressure;
    if (pressure > 0)
      force +=
          std::abs(c.weight[k]) * pressure * cloths_[cloth].model->topology->area[v - first_vertex_[cloth]];
  }
  return force / (kPressed * kept_gap(c));
}

/// Whether the features are predicted to slide over other cells within the step.
bool ContactSystem::slides_far(const Constraint& c) const {
  Vec3 way = -step_.step * c.surface_velocity;
  double edge = std::numeric_limits<double>::infinity();
  for (int k = 0; k < c.num_vertices; ++k) {
    const int v = c.vertex[k];
    way += c.weight[k] * (motion_.end[v] - motion_.start[v]);
    if (v < first_vertex_.back()) edge = std::min(edge, rest_edges_[mesh_of(first_vertex_, v)].mean);
  }
  return (way - way.dot(c.normal) * c.normal).norm() > kFarSlide * edge;
}

void ContactSystem::find_contacts(std::vector<Contact>& contacts) {
  const WorkScope scope(step_.clock, &WorkTimes::rows);
  contacts.clear();
  solved_for_.swap(constraints_);
  std::erase_if(solved_for_, [](const Constraint& c) { return c.inverse_mass == 0; });
  const double h = step_.step;
  for (const Constraint& c : solved_for_) {
    Contact& contact = contacts.emplace_back();
    contact.num_particles = 0;
    contact.normal = c.normal;
    contact.offset = c.target;
    contact.gap = kept_gap(c);
    contact.depth_before = depth_at_start(c);
    contact.stick_point = h * c.surface_velocity;
    contact.friction = c.friction;
    const double usual =
        std::max((c.shape >= 0 ? kShapeStiffness : kPairStiffness) / (c.inverse_mass * h * h),
                 has_pressure_ ? pressure_stiffness(c) : 0.0);
    contact.stiffness = usual;
    contact.lasting_force = slides_far(c) ? 0 : memory_.lasting_force(c);
    if (contact.lasting_force > 0) {
      contact.stiffness =
          std::clamp(contact.lasting_force / (kPressed * contact.gap), usual, kMostStiff * usual);
      contact.stiffened = contact.stiffness / usual;
    }
    for (int k = 0; k < c.num_vertices; ++k) {
      const int v = c.vertex[k];
      const double w = c.weight[k];
      if (v < first_vertex_.back()) {
        const Vec3& origin = cloths_[mesh_of(first_vertex_, v)].state->origin;
        contact.particle[contact.num_particles] = v;
        contact.weight[contact.num_particles++] = w;
        contact.offset -= w * c.normal.dot(origin);
        contact.stick_point += w * (motion_.start[v] - origin);
      } else {
        contact.offset -= w * c.normal.dot(motion_.end[v]);
        contact.stick_point -= w * (motion_.end[v] - motion_.start[v]);
      }
    }
  }
}

/// Penetration of a collider, 0 for cloth. For a primitive shape relative to its start pose, because the
/// constraint's plane moves in a straight line.
double ContactSystem::depth_at_start(const Constraint& c) const {
  if (c.is_caught) return 0;
  if (c.shape < 0) return is_on_body(c) ? c.target - c.normal.dot(c.sum(motion_.start)) : 0;
  return clearance_of(c) - find_nearest(shapes_[c.shape].before, c, motion_.start).distance;
}

int ContactSystem::diverged_cloth() const {
  return is_clear_ || proximity_.diverged_vertex() < 0 ? -1
                                                       : mesh_of(first_vertex_, proximity_.diverged_vertex());
}

void ContactSystem::store_forces() {
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    if (is_placed_ && is_predicted_)
      memory_.store(first_vertex_[c], *cloths_[c].state);
    else
      cloths_[c].state->history.pressed = {};
  }
}

/// Whether the solve separated all cloths of a constraint.
bool ContactSystem::is_solved(const Constraint& c) const {
  for (int k = 0; k < c.num_vertices; ++k) {
    const int v = c.vertex[k];
    if (v < first_vertex_.back() && !is_solved_[mesh_of(first_vertex_, v)]) return false;
  }
  return true;
}

/// Marks the constraint's cloths as not separated. Returns whether this changed any of them.
bool ContactSystem::mark_unsolved(const Constraint& c) {
  bool has_changed = false;
  for (int k = 0; k < c.num_vertices; ++k) {
    if (c.vertex[k] >= first_vertex_.back()) continue;
    char& is_solved = is_solved_[mesh_of(first_vertex_, c.vertex[k])];
    has_changed |= is_solved != 0;
    is_solved = 0;
  }
  return has_changed;
}

/// Whether the solve separated all cloths, and each ended where contacts were searched.
bool ContactSystem::matches_prediction() const {
  if (expected_.empty()) return false;
  if (std::any_of(is_solved_.begin(), is_solved_.end(), [](char is) { return is == 0; })) return false;
  for (int v = 0; v < first_vertex_.back(); ++v) {
    const double most = 0.5 * kMaxShortfall * motion_.half_thickness[v];
    if ((motion_.end[v] - expected_[v]).squaredNorm() > most * most) return false;
  }
  return true;
}

/// Drops the constraints of cloths that the solve separated and that touch only such cloths.
void ContactSystem::leave_out_solved() {
  if (!is_predicted_) return;
  for (const Constraint& c : constraints_) {
    if (is_short(c)) mark_unsolved(c);
  }
  for (bool is_spreading = true; is_spreading;) {
    is_spreading = false;
    for (const Constraint& c : constraints_) {
      if (!is_solved(c)) is_spreading |= mark_unsolved(c);
    }
  }
  std::erase_if(constraints_, [&](const Constraint& c) { return is_solved(c); });
}

void ContactSystem::find_violations(JobSystem& jobs) {
  is_for_solve_ = is_clear_ = false;
  pressed_in_ = is_predicted_ ? kPressedIn : 0;
  constraints_.clear();
  if (is_surveyed_ || !is_placed_) {
    survey_solved();
    if (is_clear_) return;
  }
  if (!is_placed_) {
    place();
    read_ends();
  }
  update_lists(jobs);
  if (proximity_.diverged_vertex() >= 0) return;
  const bool lists_are_empty = proximity_.vertex_triangle().empty() && proximity_.edge_edge().empty();
  is_clear_ = lists_are_empty && !has_plain_shapes() && caught_.empty();
  if (is_clear_ || matches_prediction()) return;
  generate_pair_constraints(jobs);
  generate_shape_constraints(0.0);
  if (!is_predicted_) find_caught();
  is_clear_ = lists_are_empty && !is_near_shape_ && caught_.empty();
  leave_out_solved();
}

bool ContactSystem::add_missed_contacts(std::vector<Contact>& contacts, JobSystem& jobs) {
  if (!is_predicted_ || constraints_.empty()) return false;
  known_.clear();
  for (const Constraint& c : solved_for_) known_.push_back(key_of(c));
  std::sort(known_.begin(), known_.end());
  const auto is_known = [&](const Constraint& c) {
    return std::binary_search(known_.begin(), known_.end(), key_of(c));
  };
  if (std::none_of(constraints_.begin(), constraints_.end(),
                   [&](const Constraint& c) { return has_passed(c) && !is_known(c); }))
    return false;
  is_for_solve_ = true;
  pressed_in_ = 0;
  constraints_.clear();
  generate_pair_constraints(jobs);
  generate_shape_constraints(0.0);
  std::erase_if(constraints_, is_known);
  constraints_.insert(constraints_.begin(), solved_for_.begin(), solved_for_.end());
  expected_.assign(motion_.end.begin(), motion_.end.begin() + first_vertex_.back());
  find_contacts(contacts);
  return true;
}

/// How far the features end beyond the constraint's plane; negative on the free side [m].
double ContactSystem::depth_at_end(const Constraint& c) const {
  return c.target - c.normal.dot(c.sum(motion_.end));
}

/// Whether features passed through each other, or cloth through a shape's surface. On round shapes the solve
/// replaces triangles by edges: those do not count.
bool ContactSystem::has_passed(const Constraint& c) const {
  if (c.shape >= 0 && c.num_vertices == 3 && is_round(c.shape)) return false;
  const double most = c.shape >= 0 ? motion_.half_thickness[c.vertex[0]] : kept_gap(c);
  return depth_at_end(c) > most;
}

/// The features of a constraint.
ContactSystem::FeatureKey ContactSystem::key_of(const Constraint& c) {
  FeatureKey key{c.shape, -1, -1, -1, -1};
  std::copy_n(c.vertex.begin(), c.num_vertices, key.begin() + 1);
  return key;
}

/// Whether the features end nearer than the tolerance of a solve.
bool ContactSystem::is_short(const Constraint& c) const {
  return depth_at_end(c) > kMaxShortfall * kept_gap(c);
}

void ContactSystem::project_contacts(JobSystem& jobs) {
  if (constraints_.empty()) return;
  project(jobs);
  store_touched();
}

CcdFailSafeReport ContactSystem::run_ccd_fail_safe(JobSystem& jobs) {
  store_caught();
  store_forces();
  if (is_clear_) return {};
  origins_.clear();
  read_ends();
  for (const ContactCloth& cloth : cloths_) origins_.push_back(cloth.state->origin);
  if (proximity_.diverged_vertex() >= 0 || !is_within_ccd_range()) return {};
  const WorkScope scope(step_.clock, &WorkTimes::ccd);
  find_separations();
  const CcdFailSafeReport report =
      ccd_fail_safe_.resolve({&inverse_mass_, &shapes_, &first_vertex_, &origins_, &closed_meshes_,
                              &non_colliding_, &clearance_, &caught_, thickest_, separations_, step_.clock},
                             proximity_, motion_, jobs);
  if (report.hits == 0) return report;
  for (const Constraint& c : ccd_fail_safe_.pushes())
    add_contact_force(c, c.push / (step_.step * step_.step) * c.normal);
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    ClothState& state = *cloths_[c].state;
    for (int i = 0, v = first_vertex_[c]; v < first_vertex_[c + 1]; ++i, ++v) {
      const Vec3 moved = motion_.end[v] - state.position(i);
      if (moved.isZero(0)) continue;
      state.history.had_contact = true;
      state.set_position(i, motion_.end[v]);
      state.v.set(i, state.v.get(i) + moved / step_.step);
    }
  }
  return report;
}

/// CCD range: beyond a kilometre, floats are too coarse to separate cloth, and displacements of tens of
/// metres per step are no cloth motion.
bool ContactSystem::is_within_ccd_range() const {
  constexpr double kLargest = 1e3, kFarthest = 30;  // [m]
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    for (int v = first_vertex_[c]; v < first_vertex_[c + 1]; ++v) {
      const Vec3 offset = motion_.start[v] - origins_[c], way = motion_.end[v] - motion_.start[v];
      if (!(offset.cwiseAbs().maxCoeff() < kLargest && way.cwiseAbs().maxCoeff() < kFarthest)) return false;
    }
  }
  return true;
}

void ContactSystem::settle_positions() {
  const int rounds = is_predicted_ ? kRoundsAfterSolve : kRounds;
  const int passes = is_predicted_ ? kPassesAfterSolve : kPasses;
  for (int round = 0; round < rounds; ++round) {
    const double moved = project_positions(inverse_mass_, passes, constraints_, motion_.end, near_);
    if (moved < kSettled) return;
    for (Constraint& c : constraints_) {
      if (c.shape < 0 || c.is_fixed || !c.is_active) continue;
      Constraint updated = c;
      update_plane(find_nearest(shapes_[c.shape].after, c, motion_.end), updated);
      if (updated.inverse_mass > 0) c = updated;  // 0: at a pin
      c.push = 0;
    }
  }
}

void ContactSystem::project(JobSystem& jobs) {
  const WorkScope scope(step_.clock, &WorkTimes::projection);
  arrived_ = motion_.end;
  settle_positions();
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    for (int v = first_vertex_[c]; v < first_vertex_[c + 1]; ++v) {
      velocity_[v] = to_quad(cloths_[c].state->v.get(v - first_vertex_[c]));
      slowed_[v] = {};
    }
  }
  velocity_projection_.project(inverse_mass_, constraints_, velocity_, slowed_);
  for (const Constraint& c : constraints_) {
    add_contact_force(c, (c.impulse * c.normal + c.friction_impulse) / step_.step);
    if (is_predicted_) memory_.add(c, c.impulse / step_.step);
  }
  if (step_.clock && !is_predicted_)
    step_.clock->times.active += std::count_if(constraints_.begin(), constraints_.end(),
                                               [](const Constraint& c) { return c.is_active; });
  undo_slides();
  settle_positions();
  mark_touched();
  // Vertices that were moved far may now touch features beyond the search radius.
  for (int search = 0; search < kSearches && has_left_reach(); ++search) {
    arrived_ = motion_.end;
    proximity_.update(motion_, jobs);
    constraints_.clear();
    generate_pair_constraints(jobs);
    generate_shape_constraints(0.0);
    leave_out_solved();
    settle_positions();
    mark_touched();
  }
}

/// Whether any vertex was moved so far that contacts must be searched again: by more than half of the search
/// margin.
bool ContactSystem::has_left_reach() const {
  for (int v = 0; v < first_vertex_.back(); ++v) {
    const double reach = std::max(kSettled, 0.5 * motion_.half_thickness[v]);
    if (is_touched_[v] && (motion_.end[v] - arrived_[v]).squaredNorm() > reach * reach) return true;
  }
  return false;
}

/// Friction also removes this step's sliding displacement, so that sticking cloth does not creep.
void ContactSystem::undo_slides() {
  mark_touched();
  for (int v = 0; v < first_vertex_.back(); ++v) {
    if (is_touched_[v]) motion_.end[v] += step_.step * slowed_[v].to_vec3();
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
      cloths_[c].state->history.had_contact = true;
      cloths_[c].state->set_position(v - first_vertex_[c], motion_.end[v]);
      cloths_[c].state->v.set(v - first_vertex_[c], velocity_[v].to_vec3());
    }
  }
  std::fill(is_touched_.begin(), is_touched_.end(), char{0});
}

}  // namespace weft::engine
