#include "weft/world/step_check.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "weft/forces/pressure.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

constexpr double kStretch = 0.08;    // maximum gain of a spring in a step, over its rest length [1]
constexpr double kMinArea = 0.3;     // of the rest area: above, no loss of area is a fault [1]
constexpr double kAreaKept = 0.5;    // minimum share of the area at the start of the step [1]
constexpr double kEnergyRate = 0.3;  // maximum rise of energy, of the kinetic energy at the start [1/s] …
constexpr double kRiseOfThickness =
    30;  // … and of the work against gravity of lifting all by its thickness [1/s]

/// Cloth is at rest if its kinetic energy is below this share of the work of lifting it by its thickness [1].
constexpr double kAtRest = 0.05;
/// The contacts of cloth at rest settle within this share of their gaps; what stiff cloth stores by that is no fault [1].
constexpr double kSettling = 0.05;

/// Shorter steps have no energy check: what contact projection then adds does not fall with their length.
constexpr double kShortestForEnergy = 1.0 / 500;  // [s]

/// The largest gain of a structural spring in a step, over its rest length.
StepCheck check_stretch(const CheckedCloth& cloth, int index) {
  StepCheck worst{.fault = StepFault::stretch};
  const Vec3Array &x = cloth.before.x, &y = cloth.after.x;
  const auto length = [](const Vec3Array& at, int i, int j) {
    const float dx = at.x()[j] - at.x()[i], dy = at.y()[j] - at.y()[i], dz = at.z()[j] - at.z()[i];
    return std::sqrt(dx * dx + dy * dy + dz * dz);
  };
  float most = 0;
  for (const Spring& s : cloth.model.topology->springs) {
    if (s.kind != SpringKind::structural) continue;
    const auto rest = static_cast<float>(s.rest_length);
    const float before = length(x, s.i, s.j) - rest, after = length(y, s.i, s.j) - rest;
    const float gained = (after - std::max(before, 0.0f)) / rest;
    if (gained <= most) continue;
    most = gained;
    worst = {StepFault::stretch, gained / kStretch, gained, index, s.i};
  }
  return worst;
}

StepCheck check_area(const CheckedCloth& cloth, int index) {
  StepCheck worst{.fault = StepFault::collapse};
  const RestMesh& mesh = cloth.model.topology->mesh;
  const auto area_sq = [](const Vec3Array& at, const Triangle& t) {
    const Eigen::Vector3f o(at.x()[t[0]], at.y()[t[0]], at.z()[t[0]]);
    const Eigen::Vector3f a = Eigen::Vector3f(at.x()[t[1]], at.y()[t[1]], at.z()[t[1]]) - o,
                          b = Eigen::Vector3f(at.x()[t[2]], at.y()[t[2]], at.z()[t[2]]) - o;
    return static_cast<double>(a.cross(b).squaredNorm());
  };
  for (int k = 0; k < mesh.num_triangles(); ++k) {
    const Triangle& t = mesh.triangles[k];
    const TriangleCorners rest = mesh.corners(k);
    const double rest_sq = (rest[1] - rest[0]).cross(rest[2] - rest[0]).squaredNorm(),
                 now_sq = area_sq(cloth.after.x, t);
    if (now_sq >= kMinArea * kMinArea * rest_sq) continue;
    const double kept = std::sqrt(now_sq / area_sq(cloth.before.x, t));
    const double severity = kAreaKept / std::max(kept, 1e-3);
    if (severity > worst.severity)
      worst = {StepFault::collapse, severity, std::sqrt(now_sq / rest_sq), index, t[0]};
  }
  return worst;
}

/// Sum of the sizes of the gas's forces [N].
double compute_push(const ClothModel& model, const ClothState& state) {
  if (!model.gas.is_active()) return 0;
  double area = 0;
  for (const auto& [a, b, c] : model.topology->mesh.triangles)
    area += 0.5 * (state.x.get(b) - state.x.get(a)).cross(state.x.get(c) - state.x.get(a)).norm();
  return std::abs(gas_excess(model.gas, compute_volume(model, state))) * area;
}

/// The energy of moving every particle by a share of the thickness, against its springs or elements [J].
double compute_settling(const ClothModel& model) {
  const double way = kSettling * model.material.thickness;
  return 0.5 * way * way * std::accumulate(model.stiffness_sum.begin(), model.stiffness_sum.end(), 0.0);
}

StepCheck check_energy(std::span<const CheckedCloth> cloths, const Vec3& gravity, double step) {
  double rise = 0, kinetic = 0, kinetic_after = 0, lift = 0, settling = 0;
  for (const CheckedCloth& c : cloths) {
    kinetic += compute_kinetic_energy(c.model, c.before);
    kinetic_after += compute_kinetic_energy(c.model, c.after);
    rise += compute_gravity_energy(c.model, c.after, gravity) -
            compute_gravity_energy(c.model, c.before, gravity) + compute_elastic_energy(c.model, c.after) -
            compute_elastic_energy(c.model, c.before);
    lift += c.model.material.thickness * compute_push(c.model, c.before);
    settling += compute_settling(c.model);
    for (const double m : c.model.mass) lift += m * gravity.norm() * c.model.material.thickness;
  }
  rise += kinetic_after - kinetic;
  double tolerance = step * (kEnergyRate * kinetic + kRiseOfThickness * lift);
  if (std::max(kinetic, kinetic_after) < kAtRest * lift) tolerance += settling;
  return {StepFault::energy, std::max(0.0, rise / tolerance), rise, -1, -1};
}

}  // namespace

StepCheck check_step(std::span<const CheckedCloth> cloths, const Vec3& gravity, double step, bool is_driven) {
  StepCheck worst;
  bool is_pushed = false;
  for (std::size_t c = 0; c < cloths.size(); ++c) {
    if (!cloths[c].after.history.had_contact && !cloths[c].model.gas.is_active()) continue;
    is_pushed = true;
    worst.include(check_stretch(cloths[c], static_cast<int>(c)));
    worst.include(check_area(cloths[c], static_cast<int>(c)));
  }
  if (is_pushed && !is_driven && step > kShortestForEnergy)
    worst.include(check_energy(cloths, gravity, step));
  return worst;
}

}  // namespace weft::engine
