#include "weft/contact/contact_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "weft/contact/caught_cloth.h"
#include "weft/contact/pair_constraints.h"
#include "weft/contact/repair_input.h"
#include "weft/contact/solve_contacts.h"

namespace weft::engine {
namespace {

constexpr int kSearches = 6;  // maximum of repeated contact searches after friction

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

Proximity::Slack slack_of(std::span<const ContactCloth> cloths) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Proximity::Slack slack{kInfinity, kInfinity, 0};
  for (const ContactCloth& cloth : cloths) {
    const Proximity::Slack own = slack_of(*cloth.model->topology, cloth.model->material.thickness);
    slack = {std::min(slack.most, own.most), std::min(slack.least, own.least),
             std::max(slack.narrow, own.narrow)};
  }
  return slack;
}

Patches build_patches(const Numbering& numbering, const Surface& surface, const std::vector<Vec3>& rest,
                      JobSystem& jobs) {
  Patches patches;
  int triangle = 0;
  for (int c = 0; c < numbering.num_cloths(); ++c) {
    const ClothTopology& topology = *numbering.topologies[c];
    const int end = triangle + topology.mesh.num_triangles();
    if (topology.grid)
      patches.add_grid(surface, *topology.grid, numbering.first_vertex[c], triangle);
    else
      patches.add_mesh(surface, rest, triangle, end, jobs);
    triangle = end;
  }
  patches.add_body(surface, triangle, static_cast<int>(surface.triangles.size()));
  return patches;
}

/// The body of each triangle, as in PairTable::non_colliding().
std::vector<int> bodies_of_triangles(const Numbering& numbering) {
  std::vector<int> result;
  for (int c = 0; c < numbering.num_cloths(); ++c)
    result.insert(result.end(), numbering.topologies[c]->mesh.num_triangles(), c);
  for (const ColliderMesh& body : numbering.bodies)
    result.resize(body.end_triangle, numbering.num_cloths() + body.collider);
  return result;
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

/// Separating axes for the CCD fail-safe, from the triangles that project_contacts found.
void find_separations(std::span<const Constraint> constraints, std::vector<Separation>& separations) {
  separations.clear();
  for (const Constraint& c : constraints) {
    if (c.shape < 0 || c.num_vertices < 3) continue;
    separations.push_back({c.shape, {c.vertex[0], c.vertex[1], c.vertex[2]}, c.normal});
  }
}

}  // namespace

void ContactSystem::begin_step(std::span<const ContactCloth> cloths, const std::vector<Collider>& colliders,
                               const ContactStep& step, JobSystem& jobs) {
  step_ = step;
  is_predicted_ = is_placed_ = has_few_ = is_clear_ = false;
  forces_.clear();
  caught_.clear();
  bodies_.cloths.assign(cloths.begin(), cloths.end());
  bodies_.step = step.step;
  bodies_.shapes.clear();
  const double start = step.time - step.step;
  for (const Collider& c : colliders) {
    bodies_.shapes.push_back({&c, shape_at(c, start), shape_at(c, step.time), c.motion.at(start),
                              c.motion.at(step.time), pivot(c.shape)});
  }
  proximity_.measure(step.clock);
  if (!bodies_.numbering.holds_for(cloths, colliders)) renumber(colliders, jobs);
  bodies_.surface = &proximity_.surface();
  bodies_.thickest = 0;
  bodies_.thinnest = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < cloths.size(); ++c) {
    starts_[c] = cloths[c].state->x;
    const double half_thickness = cloths[c].model->material.thickness / 2;
    bodies_.thickest = std::max(bodies_.thickest, half_thickness);
    bodies_.thinnest = std::min(bodies_.thinnest, half_thickness);
  }
  if (!survey_.may_begin(bodies_, step.rules)) place();
}

void ContactSystem::renumber(const std::vector<Collider>& colliders, JobSystem& jobs) {
  Surface surface;
  std::vector<Vec3> rest;
  bodies_.numbering = number_bodies(bodies_.cloths, colliders, surface, rest);
  const Numbering& numbering = bodies_.numbering;
  const int n = surface.num_vertices, num_cloth_vertices = numbering.num_cloth_vertices();
  bodies_.motion.start.assign(n, Vec3::Zero());
  bodies_.motion.end.assign(n, Vec3::Zero());
  bodies_.motion.half_thickness.assign(n, 0.0);
  bodies_.inverse_mass.assign(n, 0.0);
  std::vector<int> collider_of_vertex;  // (vertices of meshes)
  for (const ColliderMesh& body : numbering.bodies)
    collider_of_vertex.resize(body.end_vertex - num_cloth_vertices, body.collider);
  caught_.reset(num_cloth_vertices, std::move(collider_of_vertex));
  int num_cloth_triangles = 0;
  for (const auto& topology : numbering.topologies) num_cloth_triangles += topology->mesh.num_triangles();
  Patches patches = build_patches(numbering, surface, rest, jobs);
  proximity_.reset(std::move(surface), std::move(patches), std::move(rest), num_cloth_vertices,
                   num_cloth_triangles, slack_of(bodies_.cloths));
  proximity_.set_bodies(bodies_of_triangles(numbering));
  survey_.reset(bodies_.cloths);
  starts_.resize(bodies_.cloths.size());
  is_clearance_known_ = false;
}

/// Stores the start of the step, as the contact search requires it.
void ContactSystem::place() {
  is_placed_ = true;
  double travel_sq = 0;  // since the last step with a contact search
  bodies_.for_particles([&](int c, int i, int v) {
    const ContactCloth& cloth = bodies_.cloths[c];
    const Vec3 start = cloth.state->origin + starts_[c].get(i);
    travel_sq = farther_sq(travel_sq, start - bodies_.motion.start[v]);
    bodies_.motion.start[v] = start;
    bodies_.motion.half_thickness[v] = cloth.model->material.thickness / 2;
    bodies_.inverse_mass[v] = (*cloth.is_pinned)[i] ? 0.0 : 1 / cloth.model->mass[i];
  });
  const double unknown = std::numeric_limits<double>::infinity();
  shape_constraints_.begin_step(bodies_, is_clearance_known_ ? std::sqrt(travel_sq) : unknown);
  is_clearance_known_ = true;
  place_bodies();
  bodies_.pairs.fill(bodies_.cloths, bodies_.shapes, step_.rules);
  proximity_.set_non_colliding(bodies_.pairs.non_colliding());
  store_velocities();
  if (is_predicted_) recall_forces();
  recall_caught(bodies_, caught_);
}

void ContactSystem::place_bodies() {
  for (const ColliderMesh& body : bodies_.numbering.bodies) {
    const MovingShape& shape = bodies_.shapes[body.collider];
    const MeshShape &before = std::get<MeshShape>(shape.before), &after = std::get<MeshShape>(shape.after);
    for (int v = body.first_vertex; v < body.end_vertex; ++v) {
      bodies_.motion.start[v] = before.vertex(v - body.first_vertex);
      bodies_.motion.end[v] = after.vertex(v - body.first_vertex);
    }
  }
}

/// Stores velocities at the start of the step, for a mesh collider the mean over the step; only where static
/// friction is set.
void ContactSystem::store_velocities() {
  std::vector<Vec3>& velocities = bodies_.velocity_before;
  velocities.clear();
  if (!bodies_.pairs.has_static_friction()) return;
  bodies_.for_particles([&](int c, int i, int) { velocities.push_back(bodies_.cloths[c].state->v.get(i)); });
  for (std::size_t v = velocities.size(); v < bodies_.motion.end.size(); ++v)
    velocities.push_back(bodies_.mean_velocity(static_cast<int>(v)));
}

void ContactSystem::recall_forces() {
  memory_.begin_step(bodies_.num_cloth_vertices());
  for (int c = 0; c < bodies_.num_cloths(); ++c)
    memory_.read(bodies_.numbering.first_vertex[c], *bodies_.cloths[c].state);
}

void ContactSystem::store_forces() {
  for (int c = 0; c < bodies_.num_cloths(); ++c) {
    ClothState& state = *bodies_.cloths[c].state;
    if (is_placed_ && is_predicted_)
      memory_.store(bodies_.numbering.first_vertex[c], state);
    else
      state.history.pressed = {};
  }
}

void ContactSystem::read_ends() {
  bodies_.for_particles(
      [&](int c, int i, int v) { bodies_.motion.end[v] = bodies_.cloths[c].state->position(i); });
}

void ContactSystem::read_survey(Survey::Result result) {
  is_clear_ = result == Survey::Result::clear;
  has_few_ = result == Survey::Result::few;
}

void ContactSystem::predict(const Vec3& acceleration, std::span<const Vec3> pin_targets, JobSystem& jobs) {
  is_predicted_ = true;
  constraints_.clear();
  expected_.clear();
  if (is_placed_) {
    recall_forces();
  } else {
    {
      const WorkScope scope(step_.clock, &WorkTimes::lists);
      read_survey(survey_.survey_expected(bodies_, starts_, acceleration, pin_targets));
    }
    if (is_clear_) return;
    place();
  }
  expect_motion(acceleration, pin_targets);
  find_candidates(acceleration, jobs);
  expected_.assign(bodies_.motion.end.begin(), bodies_.motion.end.begin() + bodies_.num_cloth_vertices());
}

/// Predicts the motion with the acceleration that acted in the last step, ballistic_ with all of it.
void ContactSystem::expect_motion(const Vec3& acceleration, std::span<const Vec3> pin_targets) {
  const double h = bodies_.step;
  SurfaceMotion& motion = bodies_.motion;
  ballistic_ = motion.end;
  std::size_t pin = 0;
  bodies_.for_particles([&](int c, int i, int v) {
    if ((*bodies_.cloths[c].is_pinned)[i]) {
      motion.end[v] = ballistic_[v] = pin_targets[pin++];
      return;
    }
    const ClothState& state = *bodies_.cloths[c].state;
    const Vec3 inertial = motion.start[v] + h * state.v.get(i);
    motion.end[v] = inertial + h * h * felt_acceleration(state, i, acceleration);
    ballistic_[v] = inertial + h * h * acceleration;
  });
}

void ContactSystem::find_candidates(const Vec3& acceleration, JobSystem& jobs) {
  update_lists(jobs);
  if (proximity_.diverged_vertex() >= 0) return;
  // Cloth on a shape is predicted to fall into it, and the solve lifts it out; cloth on cloth stays in place.
  std::swap(bodies_.motion.end, ballistic_);
  generate_shape_constraints(Purpose::solve, 1.0, bodies_.step * bodies_.step * acceleration.norm());
  std::swap(bodies_.motion.end, ballistic_);
  generate_pair_constraints(Purpose::solve, jobs);
  if (constraints_.empty()) return;
  lower_between(Purpose::solve, 1.0);
  catch_cloth();
  // Cloth that is stopped far from its predicted end is hit by the cloth behind it: search pairs at the more
  // likely positions.
  {
    const WorkScope scope(step_.clock, &WorkTimes::projection);
    if (!projection_.project_prediction(bodies_, constraints_)) return;
  }
  std::erase_if(constraints_, [](const Constraint& c) { return c.shape < 0; });
  proximity_.update(bodies_.motion, jobs);
  generate_pair_constraints(Purpose::solve, jobs);
  lower_between(Purpose::solve, 1.0);
}

/// Updates the lists for the motion, which the last survey covered.
void ContactSystem::update_lists(JobSystem& jobs) {
  if (has_few_)
    proximity_.update_among(bodies_.motion, survey_.uncertain(), Survey::kSlackOfFew * 2 * bodies_.thinnest,
                            jobs);
  else
    proximity_.update(bodies_.motion, jobs);
}

void ContactSystem::generate_pair_constraints(Purpose purpose, JobSystem& jobs) {
  const WorkScope scope(step_.clock, &WorkTimes::narrow_phase);
  if (step_.clock) step_.clock->add_look(proximity_.vertex_triangle().size() + proximity_.edge_edge().size());
  weft::engine::generate_pair_constraints({bodies_, proximity_, caught_, memory_, purpose}, jobs, chunks_,
                                          constraints_);
}

/// `stretch`: how much longer than in the lists an edge may be [m].
void ContactSystem::generate_shape_constraints(Purpose purpose, double share_of_travel, double stretch) {
  const WorkScope scope(step_.clock, &WorkTimes::narrow_phase);
  add_caught_constraints(bodies_, caught_, constraints_);
  is_near_shape_ = bodies_.has_plain_shapes() &&
                   shape_constraints_.generate({bodies_, caught_, purpose, share_of_travel},
                                               proximity_.longest_edge() + stretch, constraints_);
}

void ContactSystem::lower_between(Purpose purpose, double share_of_travel) {
  if (!is_near_shape_) return;
  const WorkScope scope(step_.clock, &WorkTimes::narrow_phase);
  const bool is_solved = purpose == Purpose::after_solve;
  shape_constraints_.lower_between({bodies_, caught_, purpose, share_of_travel},
                                   is_solved ? solved_.constraints() : std::span<const Constraint>(),
                                   constraints_);
}

/// The constraints at the end positions.
void ContactSystem::generate_constraints_after(JobSystem& jobs) {
  constraints_.clear();
  generate_pair_constraints(after(), jobs);
  generate_shape_constraints(after(), 0.0);
  lower_between(after(), 0.0);
}

/// Finds newly caught cloth, and replaces its constraints.
void ContactSystem::catch_cloth() {
  if (!find_caught(bodies_, constraints_, caught_)) return;
  std::erase_if(constraints_, [&](const Constraint& c) { return c.is_caught || caught_.replaces(c); });
  add_caught_constraints(bodies_, caught_, constraints_);
}

void ContactSystem::find_contacts(std::vector<Contact>& contacts) {
  const WorkScope scope(step_.clock, &WorkTimes::rows);
  std::erase_if(constraints_, [](const Constraint& c) { return c.inverse_mass == 0; });
  solved_.set(constraints_);
  contacts.clear();
  for (const Constraint& c : solved_.constraints()) contacts.push_back(make_contact(c, bodies_, memory_));
}

void ContactSystem::read_solution(std::span<const Contact> contacts) {
  if (is_placed_) read_ends();
  forces_.clear();
  memory_.restart();
  solved_.read(contacts, bodies_.numbering, is_predicted_);
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    const Contact& contact = contacts[n];
    const Constraint& c = solved_.constraints()[n];
    add_force(c, contact.force);
    memory_.add(c, contact.push);
    if (step_.clock && contact.has_pushed) ++step_.clock->times.active;
  }
}

void ContactSystem::add_force(const Constraint& c, const Vec3& force) {
  if (step_.tracks) forces_.add(c, force);
}

/// Whether the solve separated all cloths, and each ended where contacts were searched.
bool ContactSystem::matches_prediction() const {
  if (expected_.empty() || !solved_.are_all_separated()) return false;
  for (std::size_t v = 0; v < expected_.size(); ++v) {
    const double most = 0.5 * kMaxShortfall * bodies_.motion.half_thickness[v];
    if ((bodies_.motion.end[v] - expected_[v]).squaredNorm() > most * most) return false;
  }
  return true;
}

void ContactSystem::find_violations(JobSystem& jobs) {
  is_clear_ = false;
  constraints_.clear();
  if (has_few_ || !is_placed_) {
    const WorkScope scope(step_.clock, &WorkTimes::lists);
    read_survey(survey_.survey_solved(bodies_, starts_, is_predicted_));
  }
  if (is_clear_) return;
  if (!is_placed_) {
    place();
    read_ends();
  }
  update_lists(jobs);
  if (proximity_.diverged_vertex() >= 0) return;
  const bool lists_are_empty = proximity_.vertex_triangle().empty() && proximity_.edge_edge().empty();
  is_clear_ = lists_are_empty && !bodies_.has_plain_shapes() && caught_.empty();
  if (is_clear_ || matches_prediction()) return;
  generate_constraints_after(jobs);
  if (!is_predicted_) catch_cloth();
  is_clear_ = lists_are_empty && !is_near_shape_ && caught_.empty();
  if (is_predicted_) solved_.leave_out_separated(bodies_, constraints_);
}

bool ContactSystem::add_missed_contacts(std::vector<Contact>& contacts, JobSystem& jobs) {
  if (!is_predicted_ || constraints_.empty()) return false;
  solved_.sort_known();
  const auto is_known = [&](const Constraint& c) { return solved_.is_known(c); };
  if (std::none_of(constraints_.begin(), constraints_.end(),
                   [&](const Constraint& c) { return has_passed(c) && !is_known(c); }))
    return false;
  constraints_.clear();
  generate_pair_constraints(Purpose::solve, jobs);
  generate_shape_constraints(Purpose::solve, 0.0);
  std::erase_if(constraints_, is_known);
  constraints_.insert(constraints_.begin(), solved_.constraints().begin(), solved_.constraints().end());
  lower_between(Purpose::solve, 0.0);
  expected_.assign(bodies_.motion.end.begin(), bodies_.motion.end.begin() + bodies_.num_cloth_vertices());
  find_contacts(contacts);
  return true;
}

/// Whether features passed through each other, or cloth through a shape's surface. On round shapes the solve has no
/// triangles: those do not count.
bool ContactSystem::has_passed(const Constraint& c) const {
  if (c.shape >= 0 && c.num_vertices == 3 && bodies_.is_round(c.shape, c.vertex[0])) return false;
  const double gap = bodies_.gap_of(c, Purpose::after_solve);
  if (c.shape < 0) return bodies_.depth_at_end(c) > gap;
  const double lift = bodies_.clearance_of(c, Purpose::after_solve) - gap;
  return bodies_.depth_at_end(c) > bodies_.motion.half_thickness[c.vertex[0]] + lift;
}

void ContactSystem::project_contacts(JobSystem& jobs) {
  if (constraints_.empty()) return;
  const WorkScope scope(step_.clock, &WorkTimes::projection);
  projection_.begin(bodies_);
  projection_.take(bodies_, constraints_);
  projection_.settle(bodies_, after(), constraints_);
  projection_.project_velocities(bodies_, constraints_);
  for (const Constraint& c : constraints_) {
    add_force(c, (c.impulse * c.normal + c.friction_impulse) / bodies_.step);
    if (is_predicted_)
      memory_.add(c, c.impulse / bodies_.step);
    else if (step_.clock)
      step_.clock->times.active += c.is_active;
  }
  projection_.settle(bodies_, after(), constraints_);
  // Vertices that were moved far may now touch features beyond the search radius.
  for (int search = 0; search < kSearches && projection_.has_left_reach(bodies_); ++search) {
    proximity_.update(bodies_.motion, jobs);
    generate_constraints_after(jobs);
    if (is_predicted_) solved_.leave_out_separated(bodies_, constraints_);
    projection_.take(bodies_, constraints_);
    projection_.settle(bodies_, after(), constraints_);
  }
  projection_.store(bodies_);
}

CcdFailSafeReport ContactSystem::run_ccd_fail_safe(JobSystem& jobs) {
  newly_caught_ = store_caught(bodies_, caught_);
  store_forces();
  if (is_clear_) return {};
  origins_.clear();
  read_ends();
  for (const ContactCloth& cloth : bodies_.cloths) origins_.push_back(cloth.state->origin);
  if (proximity_.diverged_vertex() >= 0 || !is_within_ccd_range()) return {};
  const WorkScope scope(step_.clock, &WorkTimes::ccd);
  find_separations(constraints_, separations_);
  const CcdFailSafeReport report = ccd_fail_safe_.resolve({.inverse_mass = &bodies_.inverse_mass,
                                                           .shapes = &bodies_.shapes,
                                                           .first_vertex = &bodies_.numbering.first_vertex,
                                                           .origins = &origins_,
                                                           .bodies = &bodies_.numbering.bodies,
                                                           .non_colliding = &bodies_.pairs.non_colliding(),
                                                           .clearance = &shape_constraints_.clearance(),
                                                           .caught = &caught_,
                                                           .thickest = bodies_.thickest,
                                                           .separations = separations_,
                                                           .clock = step_.clock},
                                                          proximity_, bodies_.motion, jobs);
  if (report.hits == 0) return report;
  for (const Constraint& c : ccd_fail_safe_.pushes())
    add_force(c, c.push / (bodies_.step * bodies_.step) * c.normal);
  bodies_.for_particles([&](int c, int i, int v) {
    ClothState& state = *bodies_.cloths[c].state;
    const Vec3 moved = bodies_.motion.end[v] - state.position(i);
    if (moved.isZero(0)) return;
    state.history.had_contact = true;
    state.set_position(i, bodies_.motion.end[v]);
    state.v.set(i, state.v.get(i) + moved / bodies_.step);
  });
  return report;
}

/// CCD range: beyond a kilometre, floats are too coarse to separate cloth, and displacements of tens of
/// metres per step are no cloth motion.
bool ContactSystem::is_within_ccd_range() const {
  constexpr double kLargest = 1e3, kFarthest = 30;  // [m]
  bool is_within = true;
  bodies_.for_particles([&](int c, int, int v) {
    const Vec3& start = bodies_.motion.start[v];
    const Vec3 offset = start - origins_[c], way = bodies_.motion.end[v] - start;
    is_within &= offset.cwiseAbs().maxCoeff() < kLargest && way.cwiseAbs().maxCoeff() < kFarthest;
  });
  return is_within;
}

int ContactSystem::diverged_cloth() const {
  const int vertex = proximity_.diverged_vertex();
  return is_clear_ || vertex < 0 ? -1 : bodies_.numbering.cloth_of(vertex);
}

Intersections ContactSystem::find_intersections(std::span<const ContactCloth> cloths,
                                                const std::vector<Collider>& colliders,
                                                const ContactStep& now, JobSystem& jobs) {
  begin_step(cloths, colliders, now, jobs);
  if (!is_placed_) place();
  return weft::engine::find_intersections(make_repair_input(bodies_), positions_now(bodies_));
}

UntangleResult ContactSystem::untangle(std::span<const ContactCloth> cloths,
                                       const std::vector<Collider>& colliders, const ContactStep& now,
                                       JobSystem& jobs, const std::function<void(int round)>& on_round) {
  begin_step(cloths, colliders, now, jobs);
  if (!is_placed_) place();
  std::vector<Vec3> positions = positions_now(bodies_);
  const UntangleResult result = weft::engine::untangle(make_repair_input(bodies_), positions, on_round);
  bodies_.for_particles([&](int c, int i, int v) {
    if (positions[v] == bodies_.motion.start[v]) return;
    ClothState& state = *bodies_.cloths[c].state;
    state.set_position(i, positions[v]);
    state.history.step = 0;
  });
  return result;
}

}  // namespace weft::engine
