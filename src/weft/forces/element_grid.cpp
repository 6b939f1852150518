/// Membranes and bending on a grid, as stencils. O is a triangle's right angle, H and V are the ends of its
/// legs along x and z. σ = ±1 is the sign of the legs' directions from O (−1 in cells cut from a to d, +1 in
/// the others). The stress gives springs of the slopes
///
///     w_OH = s1 dz/(2 dx) + σ s3/2      w_OV = s2 dx/(2 dz) + σ s3/2      w_HV = −σ s3/2
///
/// and the Hessian's couplings are, with α = dz/(2 dx), β = dx/(2 dz), γ = σ/2,
///
///     N_HO = |w_OH| + P + X     P = α (C11 f1 f1ᵀ + G f2 f2ᵀ)      N_ji = N_ijᵀ
///     N_OV = |w_OV| + Q + X     Q = β (C22 f2 f2ᵀ + G f1 f1ᵀ)
///     N_HV = |w_HV| − X         X = γ (C12 f1 f2ᵀ + G f2 f1ᵀ)

#include "weft/forces/element_block.h"

namespace weft::engine::kernels {
namespace {

/// A cell's triangles from the first column of a pack.
template <int W, bool kAlternates>
class Cells {
 public:
  /// Cells whose upper left particles are in row j, from column i on, i >= −1.
  WEFT_ALWAYS_INLINE Cells(const GridElements& g, std::ptrdiff_t i, int j)
      : at_(g.rows.row(j) + i), is_main_(even_from<W>(i + j)) {
    exists_ = count_below<W>(g.rows.row_length - 1, i) - count_below<W>(0, i);
  }

  WEFT_ALWAYS_INLINE std::ptrdiff_t at() const { return at_; }
  WEFT_ALWAYS_INLINE Pack<W> exists() const { return exists_; }

  /// `main` in cells cut from a to d, `other` in those cut from b to c.
  WEFT_ALWAYS_INLINE Pack<W> choose(Pack<W> main, Pack<W> other) const {
    return kAlternates ? blend<W>(is_main_, main, other) : main;
  }
  WEFT_ALWAYS_INLINE Pack<W> choose(float main, float other) const {
    return choose(broadcast<W>(main), broadcast<W>(other));
  }
  WEFT_ALWAYS_INLINE Three<W> choose(const Three<W>& main, const Three<W>& other) const {
    return {choose(main.x, other.x), choose(main.y, other.y), choose(main.z, other.z)};
  }

  /// 1 where a cell exists and is cut from a to d (from b to c).
  WEFT_ALWAYS_INLINE Pack<W> mains() const { return choose(exists_, broadcast<W>(0)); }
  WEFT_ALWAYS_INLINE Pack<W> others() const { return choose(broadcast<W>(0), exists_); }

  WEFT_ALWAYS_INLINE Frame<W> top(const GridElements& g) const {
    return {across(g, 0), choose(down(g, 1), down(g, 0))};
  }
  WEFT_ALWAYS_INLINE Frame<W> bottom(const GridElements& g) const {
    return {across(g, g.rows.stride()), choose(down(g, 0), down(g, 1))};
  }
  WEFT_ALWAYS_INLINE Stress<W> top_stress(const GridElements& g) const { return stress(g, 0); }
  WEFT_ALWAYS_INLINE Stress<W> bottom_stress(const GridElements& g) const { return stress(g, 3); }
  WEFT_ALWAYS_INLINE Tangent<W> top_tangent(const GridElements& g) const {
    return load_tangent<W>(g.plane(g.tangent, 0) + at_, g.plane_pitch());
  }
  WEFT_ALWAYS_INLINE Tangent<W> bottom_tangent(const GridElements& g) const {
    return load_tangent<W>(g.plane(g.tangent, kTangentSize) + at_, g.plane_pitch());
  }

 private:
  WEFT_ALWAYS_INLINE Three<W> across(const GridElements& g, std::ptrdiff_t from) const {
    return times<W>(1 / g.dx, minus<W>(load3<W>(g.x, at_ + from + 1), load3<W>(g.x, at_ + from)));
  }
  WEFT_ALWAYS_INLINE Three<W> down(const GridElements& g, std::ptrdiff_t from) const {
    return times<W>(1 / g.dz,
                    minus<W>(load3<W>(g.x, at_ + from + g.rows.stride()), load3<W>(g.x, at_ + from)));
  }
  WEFT_ALWAYS_INLINE Stress<W> stress(const GridElements& g, int plane) const {
    return {load<W>(g.plane(g.stress, plane) + at_), load<W>(g.plane(g.stress, plane + 1) + at_),
            load<W>(g.plane(g.stress, plane + 2) + at_)};
  }

  std::ptrdiff_t at_;
  Pack<W> exists_;
  Mask<W> is_main_;
};

WEFT_ALWAYS_INLINE Rows strain_planes(const GridElements& g, float* planes, int first) {
  return {g.plane(planes, first), g.plane(planes, first + 1), g.plane(planes, first + 2)};
}

/// Tangents of the stiffening of tops (plane 0) or bottoms (plane 3).
WEFT_ALWAYS_INLINE float* tangent_of(const GridElements& g, int plane) {
  return g.plane(g.tangent, 2 * plane);
}

template <int W, bool kAlternates>
WEFT_ALWAYS_INLINE void past_of_rows(const GridElements& g, float share, int row_begin, int row_end) {
  for (int j = row_begin; j < row_end && j + 1 < g.rows.num_rows; ++j) {
    for_packs<W>(g.rows.row_length, [&](std::ptrdiff_t i, int) WEFT_INLINE_LAMBDA {
      const Cells<W, kAlternates> cells(g, i, j);
      const auto add = [&](const Frame<W>& frame, int plane) WEFT_INLINE_LAMBDA {
        const Rows past = strain_planes(g, g.past, plane);
        const Three<W> before = load3<W>({past.x, past.y, past.z}, cells.at());
        store3<W>(past, cells.at(), plus<W>(before, times<W>(share, strain_of<W>(frame))));
      };
      add(cells.top(g), 0);
      add(cells.bottom(g), 3);
    });
  }
}

template <int W>
WEFT_ALWAYS_INLINE void past_body(const GridElements& g, float share, int row_begin, int row_end) {
  if (g.alternates) return past_of_rows<W, true>(g, share, row_begin, row_end);
  past_of_rows<W, false>(g, share, row_begin, row_end);
}

WEFT_MULTIVERSION_PACKS(past, (const GridElements& g, float share, int row_begin, int row_end),
                        (g, share, row_begin, row_end))

template <int W, bool kAlternates>
WEFT_ALWAYS_INLINE void membrane_row(const GridElements& g, int j, LaneSums<W>& energy) {
  const float quarter = 0.25f * g.dx * g.dz;
  float peak = 0;
  for_packs<W>(g.rows.row_length, [&](std::ptrdiff_t i, int part) WEFT_INLINE_LAMBDA {
    const Cells<W, kAlternates> cells(g, i, j);
    const auto add = [&](const Frame<W>& frame, int plane) WEFT_INLINE_LAMBDA {
      Three<W> e = strain_of<W>(frame);
      if (g.damping > 0) {
        const Rows past = strain_planes(g, g.past, plane);
        e = minus<W>(e, load3<W>({past.x, past.y, past.z}, cells.at()));
      }
      e = times<W>(cells.exists(), e);
      Stress<W> s = stress_of<W>(g.membrane, e);
      energy.add(part, quarter * twice_energy<W>(e, s));
      if (g.stiffening.is_set()) {
        const StiffeningAnswer<W> more =
            stiffening_answer<W>(g.stiffening, times<W>(cells.exists(), strain_of<W>(frame)));
        energy.add(part, 2 * quarter * more.energy);
        s = {s.s1 + more.stress.s1, s.s2 + more.stress.s2, s.s3 + more.stress.s3};
        store_tangent<W>(tangent_of(g, plane) + cells.at(), g.plane_pitch(), more.tangent);
        peak = larger(peak, widest<W>(more.peak));
      }
      store3<W>(strain_planes(g, g.stress, plane), cells.at(), {s.s1, s.s2, s.s3});
    };
    add(cells.top(g), 0);
    add(cells.bottom(g), 3);
  });
  if (g.stiffening.is_set()) g.peak[j] = peak;
}

template <int W>
WEFT_ALWAYS_INLINE void bending_row(const GridElements& g, int j, LaneSums<W>& energy) {
  const int first = g.rows.row(j);
  for_packs<W>(g.rows.row_length, [&](std::ptrdiff_t i, int part) WEFT_INLINE_LAMBDA {
    const std::ptrdiff_t p = first + i;
    for (int f = 0; f < GridElements::kFamilies; ++f) {
      const std::ptrdiff_t q = p + GridElements::kRow[f] * g.rows.stride() + GridElements::kColumn[f];
      const Three<W> d = minus<W>(load3<W>(g.x, q), load3<W>(g.x, p));
      Pack<W> length_sq = dot<W>(d, d);
      if (g.damping > 0) {
        const Three<W> z = minus<W>(load3<W>(g.damped, q), load3<W>(g.damped, p));
        length_sq += g.damping * dot<W>(z, z);
      }
      energy.add(part, 0.5f * load<W>(g.plane(g.bending, f) + p) * length_sq);
    }
  });
}

template <int W>
WEFT_ALWAYS_INLINE void membranes_body(const GridElements& g, int row_begin, int row_end, double* energy) {
  for (int j = row_begin; j < row_end; ++j) {
    LaneSums<W> sum;
    if (j + 1 < g.rows.num_rows) {
      if (g.alternates) {
        membrane_row<W, true>(g, j, sum);
      } else {
        membrane_row<W, false>(g, j, sum);
      }
    }
    bending_row<W>(g, j, sum);
    energy[j] = sum.total();
  }
}

WEFT_MULTIVERSION_PACKS(membranes, (const GridElements& g, int row_begin, int row_end, double* energy),
                        (g, row_begin, row_end, energy))

/// Sum of an edge's contributions from its triangles.
template <int W>
struct EdgeSum {
  Block<W> block;
  Pack<W> slope = broadcast<W>(0), stiffness = broadcast<W>(0);

  WEFT_ALWAYS_INLINE void add_slope(Pack<W> w) {
    slope += w;
    stiffness += magnitude(w);
  }
};

/// γC12 and γG, in the order of X or of Xᵀ.
template <int W>
struct Mixed {
  Pack<W> x12, x21;
};

/// X where the cell is cut from a to d and Xᵀ elsewhere, or vice versa.
template <int W, class C>
WEFT_ALWAYS_INLINE Mixed<W> mixed(const GridElements& g, const C& cells, bool main_is_plain) {
  const float c12 = 0.5f * g.membrane.c12, shear = 0.5f * g.membrane.g;
  const Mixed<W> m = main_is_plain ? Mixed<W>{cells.choose(-c12, shear), cells.choose(-shear, c12)}
                                   : Mixed<W>{cells.choose(-shear, c12), cells.choose(-c12, shear)};
  return {cells.exists() * m.x12, cells.exists() * m.x21};
}

/// Contribution of a triangle's stiffening to its cell's edge across or down: α D11 + γ D13 in place of α
/// C11, and likewise; X additionally has α D13 (or β D23).
template <int W, class C>
WEFT_ALWAYS_INLINE void add_stiffening(const GridElements& g, const C& cells, const Frame<W>& f,
                                       const Tangent<W>& d, bool is_across, bool main_is_plain,
                                       EdgeSum<W>& sum) {
  const float own = is_across ? 0.5f * g.dz / g.dx : 0.5f * g.dx / g.dz;
  const Pack<W> sign = cells.choose(-0.5f, 0.5f), turned = own * (is_across ? d.d13 : d.d23);
  const Pack<W> p1 = own * (is_across ? d.d11 : d.d33) + sign * d.d13;
  const Pack<W> p2 = own * (is_across ? d.d33 : d.d22) + sign * d.d23;
  const Pack<W> plain = sign * d.d12 + turned, crossed = sign * d.d33 + turned;
  const Pack<W> x12 = main_is_plain ? cells.choose(plain, crossed) : cells.choose(crossed, plain);
  const Pack<W> x21 = main_is_plain ? cells.choose(crossed, plain) : cells.choose(plain, crossed);
  const Pack<W> e = cells.exists();
  sum.block.add(f, e * p1, e * p2, e * x12, e * x21);
}

template <int W, class C>
WEFT_ALWAYS_INLINE void add_across(const GridElements& g, const C& cells, const Frame<W>& f,
                                   const Stress<W>& s, const Mixed<W>& m, EdgeSum<W>& sum) {
  const float alpha = 0.5f * g.dz / g.dx;
  const Pack<W> share = alpha * cells.exists();
  sum.block.add(f, g.membrane.c11 * share, g.membrane.g * share, m.x12, m.x21);
  sum.add_slope(alpha * s.s1 + cells.choose(-0.5f, 0.5f) * s.s3);
}

template <int W, class C>
WEFT_ALWAYS_INLINE void add_down(const GridElements& g, const C& cells, const Frame<W>& f, const Stress<W>& s,
                                 const Mixed<W>& m, EdgeSum<W>& sum) {
  const float beta = 0.5f * g.dx / g.dz;
  const Pack<W> share = beta * cells.exists();
  sum.block.add(f, g.membrane.g * share, g.membrane.c22 * share, m.x12, m.x21);
  sum.add_slope(beta * s.s2 + cells.choose(-0.5f, 0.5f) * s.s3);
}

/// Both triangles of cells whose diagonal has this sign of σ, where `exists` is 1.
template <int W, class C>
WEFT_ALWAYS_INLINE void add_diagonal(const GridElements& g, const C& cells, float sigma, Pack<W> exists,
                                     EdgeSum<W>& sum) {
  const Pack<W> zero = broadcast<W>(0), half = -0.5f * sigma * exists;
  const Pack<W> c12 = half * g.membrane.c12, shear = half * g.membrane.g;
  sum.block.add(cells.top(g), zero, zero, c12, shear);
  sum.block.add(cells.bottom(g), zero, zero, shear, c12);
  if (g.stiffening.is_set()) {
    const Tangent<W> t = cells.top_tangent(g), b = cells.bottom_tangent(g);
    sum.block.add(cells.top(g), half * t.d13, half * t.d23, half * t.d12, half * t.d33);
    sum.block.add(cells.bottom(g), half * b.d13, half * b.d23, half * b.d33, half * b.d12);
  }
  sum.add_slope(half * cells.top_stress(g).s3);
  sum.add_slope(half * cells.bottom_stress(g).s3);
}

template <int W, bool kAlternates>
WEFT_ALWAYS_INLINE EdgeSum<W> across_edge(const GridElements& g, std::ptrdiff_t i, int j) {
  EdgeSum<W> sum;
  if (j + 1 < g.rows.num_rows) {
    const Cells<W, kAlternates> below(g, i, j);
    add_across<W>(g, below, below.top(g), below.top_stress(g), mixed<W>(g, below, true), sum);
    if (g.stiffening.is_set())
      add_stiffening<W>(g, below, below.top(g), below.top_tangent(g), true, true, sum);
  }
  if (j > 0) {
    const Cells<W, kAlternates> above(g, i, j - 1);
    add_across<W>(g, above, above.bottom(g), above.bottom_stress(g), mixed<W>(g, above, false), sum);
    if (g.stiffening.is_set())
      add_stiffening<W>(g, above, above.bottom(g), above.bottom_tangent(g), true, false, sum);
  }
  return sum;
}

/// The triangle at a cell's left (right) edge: its bottom (top) where the cell is cut from a to d.
template <int W, class C>
WEFT_ALWAYS_INLINE void add_side(const GridElements& g, const C& cells, bool is_left, EdgeSum<W>& sum) {
  const Frame<W> top = cells.top(g), bottom = cells.bottom(g);
  const Stress<W> above = cells.top_stress(g), below = cells.bottom_stress(g);
  const auto pick = [&](const Three<W>& t, const Three<W>& b)
                        WEFT_INLINE_LAMBDA { return is_left ? cells.choose(b, t) : cells.choose(t, b); };
  const Three<W> s = pick({above.s1, above.s2, above.s3}, {below.s1, below.s2, below.s3});
  const Frame<W> frame{pick(top.f1, bottom.f1), pick(top.f2, bottom.f2)};
  add_down<W>(g, cells, frame, {s.x, s.y, s.z}, mixed<W>(g, cells, !is_left), sum);
  if (!g.stiffening.is_set()) return;
  const Tangent<W> t = cells.top_tangent(g), b = cells.bottom_tangent(g);
  const Three<W> high = pick({t.d11, t.d12, t.d13}, {b.d11, b.d12, b.d13}),
                 low = pick({t.d22, t.d23, t.d33}, {b.d22, b.d23, b.d33});
  add_stiffening<W>(g, cells, frame, {high.x, high.y, high.z, low.x, low.y, low.z}, false, !is_left, sum);
}

template <int W>
WEFT_ALWAYS_INLINE void store_edge(const GridElements& g, int family, std::ptrdiff_t i, int j,
                                   EdgeSum<W>& sum) {
  const std::ptrdiff_t at = g.rows.row(j) + i;
  sum.block.add_diagonal(sum.stiffness + (1 + g.damping) * load<W>(g.plane(g.bending, family) + at));
  sum.block.store_at(g.hessian + g.hessian_row(j, family, 0) + i, g.rows.stride());
  store(g.plane(g.slope, family) + at, sum.slope);
}

template <int W, bool kAlternates>
WEFT_ALWAYS_INLINE void blocks_of_rows(const GridElements& g, int row_begin, int row_end) {
  for (int j = row_begin; j < row_end; ++j) {
    for_packs<W>(g.rows.row_length, [&](std::ptrdiff_t i, int) WEFT_INLINE_LAMBDA {
      EdgeSum<W> across = across_edge<W, kAlternates>(g, i, j);
      store_edge<W>(g, 0, i, j, across);
    });
    if (j + 1 == g.rows.num_rows) break;
    for_packs<W>(g.rows.row_length, [&](std::ptrdiff_t i, int) WEFT_INLINE_LAMBDA {
      const Cells<W, kAlternates> right(g, i, j), left(g, i - 1, j);
      EdgeSum<W> down, main, other;
      add_side<W>(g, right, true, down);
      add_side<W>(g, left, false, down);
      store_edge<W>(g, 1, i, j, down);
      add_diagonal<W>(g, right, -1, right.mains(), main);
      store_edge<W>(g, 2, i, j, main);
      if (!kAlternates) return;
      add_diagonal<W>(g, left, 1, left.others(), other);
      store_edge<W>(g, 3, i, j, other);
    });
  }
}

template <int W>
WEFT_ALWAYS_INLINE void blocks_body(const GridElements& g, int row_begin, int row_end) {
  if (g.alternates) return blocks_of_rows<W, true>(g, row_begin, row_end);
  blocks_of_rows<W, false>(g, row_begin, row_end);
}

WEFT_MULTIVERSION_PACKS(blocks, (const GridElements& g, int row_begin, int row_end), (g, row_begin, row_end))

/// One component of the forces on row j.
template <int W>
WEFT_ALWAYS_INLINE void force_row(const GridElements& g, int j, const float* x, const float* bent,
                                  float* force) {
  const int first = g.rows.row(j), num_edges = g.num_edge_families();
  for_packs<W>(g.rows.row_length, [&](std::ptrdiff_t i, int) WEFT_INLINE_LAMBDA {
    const std::ptrdiff_t p = first + i;
    Pack<W> f = load<W>(force + p);
    const auto add = [&](const float* coupling, const float* u, int family) WEFT_INLINE_LAMBDA {
      const std::ptrdiff_t o = GridElements::kRow[family] * g.rows.stride() + GridElements::kColumn[family];
      const Pack<W> here = load<W>(u + p);
      f += load<W>(coupling + p) * (load<W>(u + p + o) - here) +
           load<W>(coupling + p - o) * (load<W>(u + p - o) - here);
    };
    for (int family = 0; family < num_edges; ++family) add(g.plane(g.slope, family), x, family);
    for (int family = 0; family < GridElements::kFamilies; ++family)
      add(g.plane(g.bending, family), bent, family);
    store(force + p, f);
  });
}

template <int W>
WEFT_ALWAYS_INLINE void forces_body(const GridElements& g, int row_begin, int row_end) {
  for (int j = row_begin; j < row_end; ++j) {
    force_row<W>(g, j, g.x.x, g.bent.x, g.force.x);
    force_row<W>(g, j, g.x.y, g.bent.y, g.force.y);
    force_row<W>(g, j, g.x.z, g.bent.z, g.force.z);
  }
}

WEFT_MULTIVERSION_PACKS(forces, (const GridElements& g, int row_begin, int row_end), (g, row_begin, row_end))

template <int W, int kEdges>
WEFT_ALWAYS_INLINE void multiply_rows(const GridElements& g, ConstRows p, Rows q, int row_begin, int row_end,
                                      double* dots) {
  const std::ptrdiff_t pitch = g.rows.stride();
  for (int j = row_begin; j < row_end; ++j) {
    const std::ptrdiff_t first = g.rows.row(j);
    LaneSums<W> sum;
    for_packs<W>(g.rows.row_length, [&](std::ptrdiff_t i, int part) WEFT_INLINE_LAMBDA {
      const std::ptrdiff_t c = first + i;
      const Three<W> a = load3<W>(p, c);
      Three<W> out = {};
      const auto add_blocks = [&](int family) WEFT_INLINE_LAMBDA {
        const int up = GridElements::kRow[family], left = GridElements::kColumn[family];
        const std::ptrdiff_t o = up * pitch + left;
        add_product<W>(g.hessian + g.hessian_row(j, family, 0) + i, pitch, minus<W>(a, load3<W>(p, c + o)),
                       out);
        add_transposed_product<W>(g.hessian + g.hessian_row(j - up, family, 0) + i - left, pitch,
                                  minus<W>(a, load3<W>(p, c - o)), out);
      };
      add_blocks(0);
      add_blocks(1);
      add_blocks(2);
      if (kEdges == 4) add_blocks(3);
      Three<W> bent = {};
      const auto add_bending = [&](int family) WEFT_INLINE_LAMBDA {
        const std::ptrdiff_t o = GridElements::kRow[family] * pitch + GridElements::kColumn[family];
        const float* b = g.plane(g.bending, family) + c;
        bent = plus<W>(bent, times<W>(load<W>(b), minus<W>(a, load3<W>(p, c + o))));
        bent = plus<W>(bent, times<W>(load<W>(b - o), minus<W>(a, load3<W>(p, c - o))));
      };
      if (kEdges == 3) add_bending(3);
      add_bending(4);
      add_bending(5);
      out = plus<W>(out, times<W>(1 + g.damping, bent));
      store3<W>(q, c, plus<W>(load3<W>({q.x, q.y, q.z}, c), out));
      sum.add(part, dot<W>(a, out));
    });
    dots[j] = sum.total();
  }
}

template <int W>
WEFT_ALWAYS_INLINE void multiply_body(const GridElements& g, ConstRows p, Rows q, int row_begin, int row_end,
                                      double* dots) {
  if (g.alternates) return multiply_rows<W, 4>(g, p, q, row_begin, row_end, dots);
  multiply_rows<W, 3>(g, p, q, row_begin, row_end, dots);
}

WEFT_MULTIVERSION_PACKS(multiply,
                        (const GridElements& g, ConstRows p, Rows q, int row_begin, int row_end,
                         double* dots),
                        (g, p, q, row_begin, row_end, dots))

}  // namespace

void grid_past(const GridElements& g, float share, int row_begin, int row_end) {
  past(g, share, row_begin, row_end);
}

void grid_membranes(const GridElements& g, int row_begin, int row_end, double* energy) {
  membranes(g, row_begin, row_end, energy);
}

void grid_blocks(const GridElements& g, int row_begin, int row_end) { blocks(g, row_begin, row_end); }

void grid_element_forces(const GridElements& g, int row_begin, int row_end) { forces(g, row_begin, row_end); }

void grid_multiply_elements(const GridElements& g, ConstRows p, Rows q, int row_begin, int row_end,
                            double* dot) {
  multiply(g, p, q, row_begin, row_end, dot);
}

}  // namespace weft::engine::kernels
