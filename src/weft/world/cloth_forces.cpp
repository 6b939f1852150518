#include "weft/world/cloth_forces.h"

#include "weft/forces/terms.h"

namespace weft::engine {
namespace {

std::vector<Vec3> sum_forces(const Terms& terms, const std::vector<Vec3>& x) {
  std::vector<Vec3> force(x.size(), Vec3::Zero());
  add_forces(terms, x, force);
  return force;
}

}  // namespace

std::vector<Vec3> compute_elastic_forces(const ClothModel& model, const ClothState& state) {
  return sum_forces(make_elastic_terms(model, state), to_doubles(state.x));
}

// In a step of 1 s that starts at 0 positions are velocities.

std::vector<Vec3> compute_damping_forces(const ClothModel& model, const ClothState& state) {
  const std::vector<Vec3> still(state.x.size(), Vec3::Zero()), shape = to_doubles(state.x);
  return sum_forces(make_damping_terms(model, {still, shape, 1}), to_doubles(state.v));
}

std::vector<Vec3> compute_wind_forces(const ClothModel& model, const ClothState& before,
                                      const ClothState& after, const Wind& wind, double time) {
  const std::vector<Vec3> still(before.x.size(), Vec3::Zero());
  return sum_forces(make_air_terms(model, before, wind, time, {still, still, 1}), to_doubles(after.v));
}

}  // namespace weft::engine
