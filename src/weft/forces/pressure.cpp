#include "weft/forces/pressure.h"

#include <limits>

#include "weft/core/logarithm.h"

namespace weft::engine {

Gas seal_gas(double pressure, double volume) {
  return {.pressure = 0, .sealed_volume = (1 + pressure / kAirPressure) * volume};
}

double gas_energy(const Gas& gas, double volume) {
  if (!gas.is_sealed()) return -gas.pressure * volume;
  if (!(volume > 0)) return std::numeric_limits<double>::infinity();
  const double growth = volume / gas.sealed_volume - 1;
  return kAirPressure * gas.sealed_volume * (growth - log_of_one_plus(growth));
}

double gas_excess(const Gas& gas, double volume) {
  return gas.is_sealed() ? kAirPressure * (gas.sealed_volume / volume - 1) : gas.pressure;
}

double gas_stiffness(const Gas& gas, double volume) {
  return gas.is_sealed() ? kAirPressure * gas.sealed_volume / (volume * volume) : 0;
}

namespace {

class GasTerm final : public Term {
 public:
  explicit GasTerm(const ClothModel& model) : gas_(model.gas), triangles_(model.topology->mesh.triangles) {}

  double energy(const Positions& x) const override { return gas_energy(gas_, volume(x)); }

  void add_force(const Positions& x, std::vector<Vec3>& force) const override {
    add_gradient(x, gas_.orientation * gas_excess(gas_, volume(x)), force);
  }

  void add_hessian(const Positions&, HessianKind, const AddBlock&) const override {}
  void list_pairs(const AddPair&) const override {}

  bool has_exact_hessian() const override { return false; }

  std::optional<RankOne> rank_one(const Positions& x) const override {
    if (!gas_.is_sealed()) return std::nullopt;
    RankOne part{gas_stiffness(gas_, volume(x)), std::vector<Vec3>(x.size(), Vec3::Zero())};
    add_gradient(x, 1, part.gradient);
    return part;
  }

 private:
  double volume(const Positions& x) const {
    return gas_.orientation * compute_signed_volume(triangles_, [&](int v) { return x[v]; });
  }

  void add_gradient(const Positions& x, double factor, std::vector<Vec3>& to) const {
    add_volume_gradient(
        triangles_, [&](int v) { return x[v]; }, [&](int v, const Vec3& part) { to[v] += factor * part; });
  }

  Gas gas_;
  std::span<const Triangle> triangles_;
};

}  // namespace

std::unique_ptr<Term> make_gas_term(const ClothModel& model, const ClothState&) {
  if (!model.gas.is_active()) return nullptr;
  return std::make_unique<GasTerm>(model);
}

}  // namespace weft::engine
