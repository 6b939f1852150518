#pragma once
/// Private to integrators/: a cloth during a substep of `xpbd`, and the pass over its springs and elements.
///
/// A substep moves particles to y = x + h v without springs. Then every spring is projected once: it moves
/// its two ends as a separate implicit Euler step of this spring would. With d = x_j − x_i, l = |d|, r the
/// motion of j relative to i in the substep so far, and W = 1/m_i + 1/m_j:
///
///     s = (h²k (l − l0) + h b d̂·r) / (1 + W (h²k + h b)),     x_i += s d̂/m_i,   x_j −= s d̂/m_j
///
/// This is XPBD with compliance 1/k and one iteration (Macklin et al. 2019, "Small Steps in Physics
/// Simulation", Eq. 7), multiplied by h²k so that k = 0 is allowed. The springs' correction c is stored
/// separately from y: v += c/h at the end, so that no velocity is the difference of two rounded positions.
///
/// Springs are coloured: springs of a colour share no particle and run in parallel, in SIMD lanes and
/// threads. Order and colours depend on the mesh only, so the result is bit-identical for any number of them.
/// The other forces follow the springs, in the same way: see xpbd_elements.h.

#include <memory>
#include <vector>

#include "weft/core/job_system.h"
#include "weft/core/pack.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

/// Parameters of a substep besides elasticity.
struct XpbdSubstep {
  float step = 0;         // h [s]
  float drag_factor = 1;  // drag factor: share of velocity that wind leaves [1]
  Eigen::Vector3f velocity_gain = Eigen::Vector3f::Zero();  // velocity gain from gravity and wind [m/s]
  bool is_projected = true;                                 // damping along the springs only
  double seam_opening = 0;                                  // forces/seam_springs.h [1]
  Gas gas;
};

class ClothProjection {
 public:
  virtual ~ClothProjection() = default;

  /// Takes masses and stiffness from a model of this topology; `pinned` particles do not yield.
  virtual void set_numbers(const ClothModel& model, const std::vector<int>& pinned) = 0;

  /// v ← drag_factor v + velocity_gain, y = x + h v, c = 0.
  virtual void predict(const XpbdSubstep& substep, JobSystem& jobs, ClothState& state) = 0;

  /// Sets a particle's y; `motion` is its displacement in the substep [m].
  virtual void move_to(int particle, const Vec3& y, const Vec3& motion) = 0;

  /// Projects every spring and element once.
  virtual void project(const XpbdSubstep& substep, JobSystem& jobs) = 0;

  /// v += c/h, then x += h v.
  virtual void finish(const XpbdSubstep& substep, JobSystem& jobs, ClothState& state) = 0;
};

/// For grids with equal springs of each kind, without elements: no index arrays.
std::unique_ptr<ClothProjection> make_grid_projection(const ClothTopology& topology);

/// For any cloth.
std::unique_ptr<ClothProjection> make_mesh_projection(const ClothModel& model);

/// Coefficients of springs that share them.
struct SpringNumbers {
  float elastic = 0;      // h²k [kg]
  float damping = 0;      // h b [kg]
  float rest_length = 0;  // l0 [m]
};

/// The push of a spring on its ends: s d̂ = along_d · d + along_r · r [kg].
template <class V>
struct SpringPush {
  V along_d, along_r;
};

/// The push of springs with |d|² = length_sq, d·r = approach, and inv_mass = W. Numbers may be floats or
/// packs. Finite for a spring of zero length.
template <bool kDamped, class V, class Number>
WEFT_ALWAYS_INLINE SpringPush<V> spring_push(const Number& elastic, const Number& damping,
                                             const Number& rest_length, bool is_projected, V length_sq,
                                             V approach, V inv_mass) {
  constexpr float kMinLengthSq = 1e-30f;
  const V zero{};
  length_sq = larger(length_sq, zero + kMinLengthSq);
  const V length = square_root(length_sq);
  const V stretch = elastic * (length - rest_length) * length;
  if (!kDamped) return {stretch / (length_sq * (1.0f + inv_mass * elastic)), zero};
  const V total = (stretch + damping * approach) / (length_sq * (1.0f + inv_mass * (elastic + damping)));
  if (is_projected) return {total, zero};
  const V sideways = damping / (1.0f + inv_mass * damping);
  return {total - sideways * approach / length_sq, sideways};
}

}  // namespace weft::engine
