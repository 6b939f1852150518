/// Implicit Euler with the constant approximate Jacobian of Desbrun (the paper's Eq. 12 with its h·H·v),
/// solved exactly by sparse Cholesky:
///
///     (m_i + h² Σ_j k_ij) Δv_i − h² Σ_j k_ij Δv_j = h (F_i + h Σ_j k_ij (v_j − v_i))
///
/// Damping and wind are linear in velocity and enter the matrix in the same way (k + d/h for k, c_w A h on
/// the diagonal); projected damping as its isotropic bound. The matrix is the same for x, y and z and for
/// every step.

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "weft/forces/damping.h"
#include "weft/forces/gravity.h"
#include "weft/forces/spring.h"
#include "weft/integrators/common.h"

namespace weft::engine {
namespace {

using Columns3 = Eigen::Matrix<double, Eigen::Dynamic, 3>;

class DesbrunIntegrator final : public ClothIntegrator {
 public:
  IntegratorReport advance(const ClothModel& model, const Environment& environment, double step, JobSystem&,
                           ClothState& state) override {
    prepare(model, environment, step);
    pins_.prepare(environment.pins, step, state);
    compute_right_side(model, environment, step, state);
    const Columns3 dv = cholesky_.solve(right_side_);
    for (int i = 0; i < model.num_particles(); ++i) {
      const Vec3 v = state.v.get(i) + dv.row(i).transpose();
      state.v.set(i, v);
      state.set_position(i, state.position(i) + step * v);
    }
    pins_.finish(environment.pins, state);
    return {};
  }

 private:
  /// The values that the matrix depends on.
  struct Key {
    std::uint64_t model_id = 0;
    double step = 0, drag = 0;
    std::vector<int> pinned;
    bool operator==(const Key&) const = default;
  };

  /// Magnitude of a spring's off-diagonal matrix element [kg].
  static double coupling(const ClothModel& model, int spring, double step) {
    return step * step * model.stiffness(spring) + step * model.material.damping;
  }

  void prepare(const ClothModel& model, const Environment& environment, double step) {
    Key key{model.id, step, environment.wind.drag, environment.pins.particle};
    if (key == key_) return;
    key_ = std::move(key);
    is_pinned_.assign(model.num_particles(), 0);
    for (const int i : environment.pins.particle) is_pinned_[i] = 1;

    // Pinned rows become Δv = prescribed; their columns go to the right side. The pattern is unchanged.
    const ClothTopology& topology = *model.topology;
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < model.num_particles(); ++i) {
      const double wind = step * environment.wind.drag * topology.area[i];
      entries.emplace_back(i, i, is_pinned_[i] ? 1.0 : model.mass[i] + wind);
    }
    for (std::size_t k = 0; k < topology.springs.size(); ++k) {
      const Spring& s = topology.springs[k];
      const double c = coupling(model, static_cast<int>(k), step);
      entries.emplace_back(s.i, s.i, is_pinned_[s.i] ? 0.0 : c);
      entries.emplace_back(s.j, s.j, is_pinned_[s.j] ? 0.0 : c);
      entries.emplace_back(std::max(s.i, s.j), std::min(s.i, s.j),
                           is_pinned_[s.i] || is_pinned_[s.j] ? 0.0 : -c);
    }
    Eigen::SparseMatrix<double> matrix(model.num_particles(), model.num_particles());
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (analyzed_ != model.topology) {
      cholesky_.analyzePattern(matrix);
      analyzed_ = model.topology;
    }
    cholesky_.factorize(matrix);
  }

  void compute_right_side(const ClothModel& model, const Environment& environment, double step,
                          const ClothState& state) {
    const ClothTopology& topology = *model.topology;
    const double b = model.material.damping;
    const bool projected = model.material.damping_kind == DampingKind::projected;
    right_side_.resize(model.num_particles(), 3);
    for (int i = 0; i < model.num_particles(); ++i) {
      const Vec3 force = gravity_force(model.mass[i], environment.gravity) +
                         wind_force(environment.wind, topology.area[i], state.v.get(i));
      right_side_.row(i) = step * force;
    }
    for (std::size_t i = 0; i < topology.springs.size(); ++i) {
      const Spring& s = topology.springs[i];
      const double k = model.stiffness(static_cast<int>(i));
      const Vec3 d = state.x.get(s.j) - state.x.get(s.i), w = state.v.get(s.j) - state.v.get(s.i);
      const Vec3 damping = projected ? projected_damping_force(b, d, w) : plain_damping_force(b, w);
      const Vec3 impulse = step * (spring_force(k, s.rest_length, d) + damping + step * k * w);
      right_side_.row(s.i) += impulse;
      right_side_.row(s.j) -= impulse;
    }
    prescribe_pins(model, environment.pins, step, state);
  }

  void prescribe_pins(const ClothModel& model, const PinTargets& pins, double step, const ClothState& state) {
    for (std::size_t p = 0; p < pins.particle.size(); ++p) {
      right_side_.row(pins.particle[p]) = pins_.velocity()[p] - state.v.get(pins.particle[p]);
    }
    const std::vector<Spring>& springs = model.topology->springs;
    for (std::size_t k = 0; k < springs.size(); ++k) {
      const Spring& s = springs[k];
      if (is_pinned_[s.i] == is_pinned_[s.j]) continue;
      const int pin = is_pinned_[s.i] ? s.i : s.j, other = s.i + s.j - pin;
      right_side_.row(other) += coupling(model, static_cast<int>(k), step) * right_side_.row(pin);
    }
  }

  Key key_;
  std::shared_ptr<const ClothTopology> analyzed_;
  std::vector<char> is_pinned_;
  PinMotion pins_;
  Columns3 right_side_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> cholesky_;
};

}  // namespace

std::unique_ptr<Integrator> make_desbrun() {
  return make_one_by_one([] { return std::make_unique<DesbrunIntegrator>(); });
}

}  // namespace weft::engine
