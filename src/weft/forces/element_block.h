#pragma once
/// Private to forces/: shared element code of the grid and mesh kernels.

#include "weft/forces/element_kernels.h"
#include "weft/forces/pack3.h"

namespace weft::engine::kernels {

/// Columns of F: images of the warp and weft directions.
template <int W>
struct Frame {
  Three<W> f1, f2;
};

/// Tensions and shear.
template <int W>
struct Stress {
  Pack<W> s1, s2, s3;
};

/// Green strain.
template <int W>
WEFT_ALWAYS_INLINE Three<W> strain_of(const Frame<W>& f) {
  return {0.5f * (dot<W>(f.f1, f.f1) - 1.0f), 0.5f * (dot<W>(f.f2, f.f2) - 1.0f), dot<W>(f.f1, f.f2)};
}

template <int W>
WEFT_ALWAYS_INLINE Stress<W> stress_of(const MembraneNumbers& c, const Three<W>& e) {
  return {c.c11 * e.x + c.c12 * e.y, c.c12 * e.x + c.c22 * e.y, c.g * e.z};
}

template <int W>
WEFT_ALWAYS_INLINE Pack<W> twice_energy(const Three<W>& e, const Stress<W>& s) {
  return e.x * s.s1 + e.y * s.s2 + e.z * s.s3;
}

/// The upper triangle of a symmetric tangent.
template <int W>
struct Tangent {
  Pack<W> d11, d12, d13, d22, d23, d33;
};

template <int W>
WEFT_ALWAYS_INLINE void store_tangent(float* to, std::ptrdiff_t pitch, const Tangent<W>& d) {
  store3<W>({to, to + pitch, to + 2 * pitch}, 0, {d.d11, d.d12, d.d13});
  store3<W>({to + 3 * pitch, to + 4 * pitch, to + 5 * pitch}, 0, {d.d22, d.d23, d.d33});
}

template <int W>
WEFT_ALWAYS_INLINE Tangent<W> load_tangent(const float* from, std::ptrdiff_t pitch) {
  return {load<W>(from),
          load<W>(from + pitch),
          load<W>(from + 2 * pitch),
          load<W>(from + 3 * pitch),
          load<W>(from + 4 * pitch),
          load<W>(from + 5 * pitch)};
}

/// Response of the strain limit to a principal Green strain: energy per area and its derivatives.
template <int W>
struct LimitPrincipal {
  Pack<W> energy, first, second;
};

template <int W>
WEFT_ALWAYS_INLINE LimitPrincipal<W> limit_principal(const LimitNumbers& n, Pack<W> stretch) {
  const LimitPull<W> pull = limit_pull<W>(n, stretch - 1.0f);
  const Pack<W> inverse = 1.0f / stretch, tension = inverse * pull.tension;
  return {pull.energy, tension, (pull.stiffness - tension) * inverse * inverse};
}

/// Contribution of limit and curves at the strain e, as in membrane_response().
template <int W>
struct StiffeningAnswer {
  Pack<W> energy, peak;  // peak: the larger principal strain
  Stress<W> stress;
  Tangent<W> tangent;
};

template <int W>
WEFT_ALWAYS_INLINE StiffeningAnswer<W> limit_answer(const LimitNumbers& n, const Three<W>& e) {
  constexpr float kMinRadius = 1e-6f;  // of Mohr's circle: below it the axes are noise
  const Pack<W> mean = 0.5f * (e.x + e.y), half = 0.5f * (e.x - e.y), shear = 0.5f * e.z;
  const Pack<W> zero = broadcast<W>(0), one = broadcast<W>(1), least = broadcast<W>(kMinRadius);
  const Pack<W> radius = square_root(half * half + shear * shear), inverse = 1.0f / larger(radius, least);
  const auto stretch = [&](Pack<W> green) WEFT_INLINE_LAMBDA {
    return square_root(larger(1.0f + 2.0f * green, broadcast<W>(1e-6f)));
  };
  const Pack<W> s1 = stretch(mean + radius);
  const LimitPrincipal<W> p1 = limit_principal<W>(n, s1), p2 = limit_principal<W>(n, stretch(mean - radius));
  const Pack<W> c = select_less(radius, least, one, half * inverse),
                s = select_less(radius, least, zero, shear * inverse);
  const Pack<W> turning = select_less(radius, least, p1.second, 0.5f * (p1.first - p2.first) * inverse);
  const Pack<W> a = 0.5f * (1.0f + c), b = 0.5f * (1.0f - c), h = 0.5f * s, g = 0.5f * c;
  const Pack<W> t = 2.0f * turning;
  return {p1.energy + p2.energy,
          s1 - 1.0f,
          {p1.first * a + p2.first * b, p1.first * b + p2.first * a, (p1.first - p2.first) * h},
          {p1.second * a * a + p2.second * b * b + t * h * h, (p1.second + p2.second) * a * b - t * h * h,
           (p1.second * a - p2.second * b) * h - t * h * g, p1.second * b * b + p2.second * a * a + t * h * h,
           (p1.second * b - p2.second * a) * h + t * h * g, (p1.second + p2.second) * h * h + t * g * g}};
}

/// Adds the response of a thread's stretch curve at its strain.
template <int W>
WEFT_ALWAYS_INLINE void add_curve(const CurveNumbers& curve, Pack<W> strain, Pack<W>& energy, Pack<W>& stress,
                                  Pack<W>& tangent) {
  for (int k = 0; k < curve.count; ++k) {
    const Pack<W> beyond = larger(strain - curve.strain[k], broadcast<W>(0)), rise = curve.slope[k] * beyond;
    energy += 0.5f * rise * beyond;
    stress += rise;
    tangent += select_less(broadcast<W>(0), beyond, broadcast<W>(curve.slope[k]), broadcast<W>(0));
  }
}

template <int W>
WEFT_ALWAYS_INLINE StiffeningAnswer<W> stiffening_answer(const StiffeningNumbers& n, const Three<W>& e) {
  StiffeningAnswer<W> answer{};
  if (n.limit.is_set()) answer = limit_answer<W>(n.limit, e);
  add_curve<W>(n.along_1, e.x, answer.energy, answer.stress.s1, answer.tangent.d11);
  add_curve<W>(n.along_2, e.y, answer.energy, answer.stress.s2, answer.tangent.d22);
  return answer;
}

/// A 3×3 block of the Hessian, signed as a coupling: q_i = Σ_j N_ij (p_i − p_j).
template <int W>
struct Block {
  Three<W> row[3] = {};

  /// += f1 (p1 f1 + x12 f2)ᵀ + f2 (p2 f2 + x21 f1)ᵀ
  template <class S>
  WEFT_ALWAYS_INLINE void add(const Frame<W>& f, S p1, S p2, S x12, S x21) {
    const Three<W> u1 = plus<W>(times<W>(p1, f.f1), times<W>(x12, f.f2));
    const Three<W> u2 = plus<W>(times<W>(p2, f.f2), times<W>(x21, f.f1));
    row[0] = plus<W>(row[0], plus<W>(times<W>(f.f1.x, u1), times<W>(f.f2.x, u2)));
    row[1] = plus<W>(row[1], plus<W>(times<W>(f.f1.y, u1), times<W>(f.f2.y, u2)));
    row[2] = plus<W>(row[2], plus<W>(times<W>(f.f1.z, u1), times<W>(f.f2.z, u2)));
  }

  WEFT_ALWAYS_INLINE void add_diagonal(Pack<W> d) {
    row[0].x += d;
    row[1].y += d;
    row[2].z += d;
  }

  WEFT_ALWAYS_INLINE void store_at(float* to, std::ptrdiff_t pitch) const {
    for (int r = 0; r < 3; ++r)
      store3<W>({to + 3 * r * pitch, to + (3 * r + 1) * pitch, to + (3 * r + 2) * pitch}, 0, row[r]);
  }
};

/// q += N d, with the block's entries `pitch` apart.
template <int W>
WEFT_ALWAYS_INLINE void add_product(const float* n, std::ptrdiff_t pitch, const Three<W>& d, Three<W>& q) {
  q.x += dot<W>(load3<W>({n, n + pitch, n + 2 * pitch}, 0), d);
  q.y += dot<W>(load3<W>({n + 3 * pitch, n + 4 * pitch, n + 5 * pitch}, 0), d);
  q.z += dot<W>(load3<W>({n + 6 * pitch, n + 7 * pitch, n + 8 * pitch}, 0), d);
}

/// q += Nᵀ d.
template <int W>
WEFT_ALWAYS_INLINE void add_transposed_product(const float* n, std::ptrdiff_t pitch, const Three<W>& d,
                                               Three<W>& q) {
  q.x += dot<W>(load3<W>({n, n + 3 * pitch, n + 6 * pitch}, 0), d);
  q.y += dot<W>(load3<W>({n + pitch, n + 4 * pitch, n + 7 * pitch}, 0), d);
  q.z += dot<W>(load3<W>({n + 2 * pitch, n + 5 * pitch, n + 8 * pitch}, 0), d);
}

}  // namespace weft::engine::kernels
