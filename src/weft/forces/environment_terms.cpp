#include "weft/forces/environment_terms.h"

#include <utility>

namespace weft::engine {
namespace {

/// A term that couples no particles.
class ParticleTerm : public Term {
 public:
  void list_pairs(const AddPair&) const final {}
};

class InertiaTerm final : public ParticleTerm {
 public:
  InertiaTerm(std::vector<double> weight, const std::vector<Vec3>& target)
      : weight_(std::move(weight)), target_(target) {}

  double energy(const Positions& x) const override {
    double energy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) energy += 0.5 * weight_[i] * (x[i] - target_[i]).squaredNorm();
    return energy;
  }

  void add_force(const Positions& x, std::vector<Vec3>& force) const override {
    for (std::size_t i = 0; i < x.size(); ++i) force[i] -= weight_[i] * (x[i] - target_[i]);
  }

  void add_hessian(const Positions& x, HessianKind, const AddBlock& add) const override {
    for (int i = 0; i < static_cast<int>(x.size()); ++i) add(i, i, weight_[i] * Mat3::Identity());
  }

 private:
  std::vector<double> weight_;  // m/h² [N/m]
  const std::vector<Vec3>& target_;
};

class WindTerm final : public ParticleTerm {
 public:
  WindTerm(const std::vector<double>& area, const Wind& wind, const Motion& motion)
      : area_(area), wind_(wind), motion_(motion) {}

  double energy(const Positions& x) const override {
    double energy = 0;
    for (int i = 0; i < static_cast<int>(x.size()); ++i) {
      energy += 0.5 * motion_.step * wind_.drag * area_[i] *
                (motion_.velocity(x, i) - wind_.velocity).squaredNorm();
    }
    return energy;
  }

  void add_force(const Positions& x, std::vector<Vec3>& force) const override {
    for (int i = 0; i < static_cast<int>(x.size()); ++i)
      force[i] += wind_force(wind_, area_[i], motion_.velocity(x, i));
  }

  void add_hessian(const Positions& x, HessianKind, const AddBlock& add) const override {
    for (int i = 0; i < static_cast<int>(x.size()); ++i)
      add(i, i, -wind_jacobian(wind_, area_[i]) / motion_.step);
  }

 private:
  const std::vector<double>& area_;
  Wind wind_;
  Motion motion_;
};

class AirTerm final : public ParticleTerm {
 public:
  AirTerm(ParticleAir air, const Motion& motion) : air_(std::move(air)), motion_(motion) {}

  double energy(const Positions& x) const override {
    double energy = 0;
    for (int i = 0; i < static_cast<int>(x.size()); ++i) {
      const Vec3 slip = air_.velocity[i] - motion_.velocity(x, i);
      energy += 0.5 * motion_.step * slip.dot(air_.matrix[i] * slip);
    }
    return energy;
  }

  void add_force(const Positions& x, std::vector<Vec3>& force) const override {
    for (int i = 0; i < static_cast<int>(x.size()); ++i)
      force[i] += air_.matrix[i] * (air_.velocity[i] - motion_.velocity(x, i));
  }

  void add_hessian(const Positions& x, HessianKind, const AddBlock& add) const override {
    for (int i = 0; i < static_cast<int>(x.size()); ++i) add(i, i, air_.matrix[i] / motion_.step);
  }

 private:
  ParticleAir air_;
  Motion motion_;
};

}  // namespace

std::unique_ptr<Term> make_inertia_term(const ClothModel& model, const std::vector<int>& pinned,
                                        const std::vector<Vec3>& target, double step) {
  std::vector<double> weight;
  for (const double mass : model.mass) weight.push_back(mass / (step * step));
  for (const int p : pinned) weight[p] = 0;
  return std::make_unique<InertiaTerm>(std::move(weight), target);
}

std::unique_ptr<Term> make_wind_term(const ClothModel& model, const Wind& wind, const Motion& motion) {
  if (wind.drag == 0) return nullptr;
  return std::make_unique<WindTerm>(model.topology->area, wind, motion);
}

ParticleAir find_air(const ClothModel& model, const ClothState& state, const Wind& wind, double time) {
  ParticleAir air;
  if (wind.air.density == 0) return air;
  const int n = model.num_particles();
  air.matrix.assign(n, Mat3::Zero());
  air.velocity.reserve(n);
  for (int i = 0; i < n; ++i)
    air.velocity.push_back(wind.velocity + gust_velocity(wind.gusts, state.position(i), time));
  for (const auto& [a, b, c] : model.topology->mesh.triangles) {
    const Vec3 xa = state.x.get(a), xb = state.x.get(b), xc = state.x.get(c);
    const Vec3 area = 0.5 * (xb - xa).cross(xc - xa);
    const Vec3 slip = (air.velocity[a] - state.v.get(a) + air.velocity[b] - state.v.get(b) + air.velocity[c] -
                       state.v.get(c)) /
                      3;
    const Mat3 third = air_matrix(wind.air, area, slip) / 3;
    for (const int v : {a, b, c}) air.matrix[v] += third;
  }
  return air;
}

std::unique_ptr<Term> make_air_term(ParticleAir air, const Motion& motion) {
  if (air.matrix.empty()) return nullptr;
  return std::make_unique<AirTerm>(std::move(air), motion);
}

}  // namespace weft::engine
