#include "weft/contact/contact_projection.h"

#include <algorithm>

#include "weft/contact/shape_constraints.h"

namespace weft::engine {
namespace {

constexpr int kRounds = 8;            // updates of the planes of round shapes
constexpr int kPasses = 8;            // over all constraints, per round
constexpr int kRoundsAfterSolve = 2;  // the same after a solve with contacts: little is left to do
constexpr int kPassesAfterSolve = 4;
constexpr double kSettled = 1e-6;  // corrections below end the rounds [m]

}  // namespace

bool ContactProjection::project_prediction(StepBodies& bodies, std::vector<Constraint>& constraints) {
  searched_ = bodies.motion.end;
  is_touched_.assign(bodies.inverse_mass.size(), 0);
  project_positions(bodies.inverse_mass, kPassesAfterSolve, constraints, bodies.motion.end, near_);
  mark_touched(constraints);
  return has_left_reach(bodies);
}

void ContactProjection::begin(const StepBodies& bodies) {
  const std::size_t n = bodies.inverse_mass.size();
  is_touched_.assign(n, 0);
  slowed_.assign(n, {});
  velocity_.resize(n);
  bodies.for_particles(
      [&](int c, int i, int v) { velocity_[v] = to_quad(bodies.cloths[c].state->v.get(i)); });
  for (std::size_t v = bodies.num_cloth_vertices(); v < n; ++v)
    velocity_[v] = to_quad(bodies.mean_velocity(static_cast<int>(v)));
}

void ContactProjection::take(const StepBodies& bodies, std::vector<Constraint>& constraints) {
  searched_ = bodies.motion.end;
  mark_alone(constraints, bodies.inverse_mass.size(), count_);
}

void ContactProjection::settle(StepBodies& bodies, Purpose purpose, std::vector<Constraint>& constraints) {
  const bool is_after_solve = purpose == Purpose::after_solve;
  const int rounds = is_after_solve ? kRoundsAfterSolve : kRounds;
  const int passes = is_after_solve ? kPassesAfterSolve : kPasses;
  for (int round = 0; round < rounds; ++round) {
    const double moved =
        project_positions(bodies.inverse_mass, passes, constraints, bodies.motion.end, near_);
    if (moved < kSettled) break;
    for (Constraint& c : constraints) {
      if (c.shape < 0 || c.is_fixed || !c.is_active) continue;
      c.push = 0;
      if (std::holds_alternative<Plane>(bodies.shapes[c.shape].after)) continue;
      Constraint updated = c;
      update_plane(bodies, purpose, updated);
      if (updated.inverse_mass > 0) c = updated;  // 0: at a pin
    }
  }
  mark_touched(constraints);
}

void ContactProjection::project_velocities(StepBodies& bodies, std::vector<Constraint>& constraints) {
  velocity_projection_.project(bodies.inverse_mass, constraints, velocity_, slowed_);
  for (int v = 0; v < bodies.num_cloth_vertices(); ++v) {
    if (is_touched_[v]) bodies.motion.end[v] += bodies.step * slowed_[v].to_vec3();
  }
}

bool ContactProjection::has_left_reach(const StepBodies& bodies) const {
  for (int v = 0; v < bodies.num_cloth_vertices(); ++v) {
    const double reach = std::max(kSettled, 0.5 * bodies.motion.half_thickness[v]);
    if (is_touched_[v] && (bodies.motion.end[v] - searched_[v]).squaredNorm() > reach * reach) return true;
  }
  return false;
}

void ContactProjection::mark_touched(const std::vector<Constraint>& constraints) {
  for (const Constraint& c : constraints) {
    if (!c.is_active) continue;
    for (int k = 0; k < c.num_vertices; ++k) is_touched_[c.vertex[k]] = 1;
  }
}

void ContactProjection::store(const StepBodies& bodies) {
  bodies.for_particles([&](int c, int i, int v) {
    if (!is_touched_[v] || bodies.inverse_mass[v] == 0) return;
    ClothState& state = *bodies.cloths[c].state;
    state.history.had_contact = true;
    state.set_position(i, bodies.motion.end[v]);
    state.v.set(i, velocity_[v].to_vec3());
  });
}

}  // namespace weft::engine
