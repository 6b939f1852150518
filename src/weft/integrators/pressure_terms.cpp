#include "weft/integrators/pressure_terms.h"

#include <vector>

namespace weft::engine {

void PressureTerms::begin(const Step& step) {
  gas_ = step.model.gas;
  topology_ = step.model.topology;
  rows_ = step.rows;
  stiffness_ = start_ = 0;
  if (!gas_.is_active()) return;
  const auto at = [&](int v) { return step.state.x.get(v); };
  start_ = gas_energy(gas_, gas_.orientation * compute_signed_volume(topology_->mesh.triangles, at));
}

double PressureTerms::volume(const Vec3Array& x) const {
  return gas_.orientation *
         compute_signed_volume(topology_->mesh.triangles, [&](int v) { return x.get(rows_.index(v)); });
}

double PressureTerms::linearise(const Place& at, JobSystem&, Vec3Array& force) {
  if (!gas_.is_active()) return 0;
  const Vec3Array& x = at.x;
  if (gradient_.size() != x.size()) gradient_ = Vec3Array(x.size());
  std::vector<Vec3> gradient(topology_->num_particles(), Vec3::Zero());
  add_volume_gradient(
      topology_->mesh.triangles, [&](int v) { return x.get(rows_.index(v)); },
      [&](int v, const Vec3& part) { gradient[v] += gas_.orientation * part; });
  const double now = volume(x), excess = gas_excess(gas_, now);
  stiffness_ = gas_stiffness(gas_, now);
  for (int v = 0; v < topology_->num_particles(); ++v) {
    const int row = rows_.index(v);
    force.set(row, force.get(row) + excess * gradient[v]);
    gradient_.set(row, gradient[v]);
  }
  return gas_energy(gas_, now) - start_;
}

double PressureTerms::energy(const Place& at, JobSystem&) {
  return gas_.is_active() ? gas_energy(gas_, volume(at.x)) - start_ : 0;
}

double PressureTerms::add_product(const Vec3Array& p, JobSystem&, Vec3Array& q) {
  if (stiffness_ == 0) return 0;
  const double along = dot(gradient_, p);
  add(stiffness_ * along, gradient_, q);
  return stiffness_ * along * along;
}

double PressureTerms::precondition(double r_dot_z, Vec3Array& z) const {
  if (stiffness_ == 0) return r_dot_z;
  const double along = dot(gradient_, z);  // also r·P⁻¹∂V, as P is symmetric
  add(-share_ * along, solved_, z);
  return r_dot_z - share_ * along * along;
}

double PressureTerms::dot(const Vec3Array& a, const Vec3Array& b) const {
  double sum = 0;
  for (int v = 0; v < topology_->num_particles(); ++v)
    sum += a.get(rows_.index(v)).dot(b.get(rows_.index(v)));
  return sum;
}

/// to += factor · values.
void PressureTerms::add(double factor, const Vec3Array& values, Vec3Array& to) const {
  for (int v = 0; v < topology_->num_particles(); ++v) {
    const int at = rows_.index(v);
    to.set(at, to.get(at) + factor * values.get(at));
  }
}

}  // namespace weft::engine
