#pragma once
/// Private to forces/: what the kernels of grids and meshes have in common.

#include "weft/forces/element_kernels.h"
#include "weft/forces/pack3.h"

namespace weft::kernels {

/// Columns of F: where warp and weft go.
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

/// A 3×3 block of the Hessian, with the sign of a coupling: q_i = Σ_j N_ij (p_i − p_j).
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

/// q += N d, the block's numbers `pitch` apart.
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

}  // namespace weft::kernels
