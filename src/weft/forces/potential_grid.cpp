/// The incremental potential on a grid: springs as stencils, family by family and row by row.

#include <algorithm>

#include "weft/forces/pack3.h"
#include "weft/forces/potential_kernels.h"

namespace weft::engine::kernels {
namespace {

constexpr float kMinLengthSq = 1e-30f;

/// 1 where a family's spring starts at column i of row j, else 0.
template <int W>
WEFT_ALWAYS_INLINE Pack<W> spring_exists(const GridPotential& g, int family, std::ptrdiff_t i, int j) {
  const int step = kFamilyOffsets[family].columns;
  const int end = g.rows.row_length - (step > 0 ? step : 0);
  Pack<W> exists = count_below<W>(end, i) - count_below<W>(step < 0 ? 1 : 0, i);
  if (g.alternates && (family == 2 || family == 5))
    exists = blend<W>(even_from<W>(i + j), exists, broadcast<W>(0));
  return exists;
}

/// ½ for structural springs on a soft border, else 1.
template <int W>
WEFT_ALWAYS_INLINE Pack<W> border_share(const GridPotential& g, int family, std::ptrdiff_t i, int j) {
  if (!g.has_soft_border || family > 1) return broadcast<W>(1);
  if (family == 0) return broadcast<W>(j == 0 || j + 1 == g.rows.num_rows ? 0.5f : 1.0f);
  return 0.5f + 0.5f * (count_below<W>(g.rows.row_length - 1, i) - count_below<W>(1, i));
}

/// The springs of one family that start in row j.
template <int W, bool kStore, bool kDamped, bool kOwn>
WEFT_ALWAYS_INLINE void spring_row(const GridPotential& g, int family, int j, LaneSums<W>& energy,
                                   float& peak) {
  using V = Pack<W>;
  const FamilyOffset o = kFamilyOffsets[family];
  const int offset = o.rows * g.rows.stride() + o.columns, first = g.rows.row(j);
  const float stiffness = g.stiffness[family], rest_length = g.rest_length[family];
  float* t_out = g.hessian + g.hessian_row(j, family, 0);
  float* slope_out = g.slope + g.slope_row(j, family);
  const float* own = kOwn ? g.own_stiffness + g.slope_row(j, family) : nullptr;
  const int pitch = g.rows.stride();
  const bool is_bending = family == 3 || family == 4, is_limited = g.limit.is_set() && !is_bending;
  for_packs<W>(g.rows.row_length, [&](std::ptrdiff_t i, int part) WEFT_INLINE_LAMBDA {
    const std::ptrdiff_t p = first + i, q = p + offset;
    const V dx = load<W>(g.x.x + q) - load<W>(g.x.x + p);
    const V dy = load<W>(g.x.y + q) - load<W>(g.x.y + p);
    const V dz = load<W>(g.x.z + q) - load<W>(g.x.z + p);
    const V length_sq = larger(dx * dx + dy * dy + dz * dz, broadcast<W>(kMinLengthSq));
    const V length = square_root(length_sq), inverse = 1.0f / length;
    const V exists = spring_exists<W>(g, family, i, j);
    const V k = kOwn ? load<W>(own + i) : stiffness * exists * border_share<W>(g, family, i, j);
    const V extension = length - rest_length;
    V slope = k * extension * inverse;
    energy.add(part, 0.5f * k * extension * extension);
    V axial = broadcast<W>(0), plain = broadcast<W>(0), across = broadcast<W>(0);
    if (is_limited) {
      const V strain = exists * extension * (1.0f / rest_length);
      const LimitPull<W> pull = limit_pull<W>(g.limit, strain);  // energy per rest length
      energy.add(part, rest_length * pull.energy);
      across = pull.tension * inverse;
      slope += across;
      axial = (1.0f / rest_length) * pull.stiffness - across;
      peak = std::max(peak, widest<W>(strain));
    }
    if (kDamped) {
      const V c = g.damping * exists + g.damping_time * k;
      const V zx = load<W>(g.damped.x + q) - load<W>(g.damped.x + p);
      const V zy = load<W>(g.damped.y + q) - load<W>(g.damped.y + p);
      const V zz = load<W>(g.damped.z + q) - load<W>(g.damped.z + p);
      if (g.is_projected) {
        const V along = (zx * dx + zy * dy + zz * dz) * inverse;
        energy.add(part, 0.5f * c * along * along);
        slope += c * along * inverse;
        axial += c;
      } else {
        energy.add(part, 0.5f * c * (zx * zx + zy * zy + zz * zz));
        plain = c;
      }
    }
    if (kStore) {
      const V t = smaller(k, magnitude(k * extension * inverse));
      const V w = square_root((k - t) + axial) * inverse;
      store(t_out + i, t + plain + across);
      store(t_out + pitch + i, w * dx);
      store(t_out + 2 * pitch + i, w * dy);
      store(t_out + 3 * pitch + i, w * dz);
      store(slope_out + i, slope);
    }
  });
}

template <int W>
WEFT_ALWAYS_INLINE void inertia_row(const GridPotential& g, int j, LaneSums<W>& energy) {
  using V = Pack<W>;
  const int first = g.rows.row(j);
  for_packs<W>(g.rows.row_length, [&](std::ptrdiff_t i, int part) WEFT_INLINE_LAMBDA {
    const std::ptrdiff_t p = first + i;
    const V ex = load<W>(g.offset.x + p), ey = load<W>(g.offset.y + p), ez = load<W>(g.offset.z + p);
    energy.add(part, 0.5f * load<W>(g.weight + p) * (ex * ex + ey * ey + ez * ez));
  });
}

template <int W, bool kStore, bool kDamped, bool kOwn>
WEFT_ALWAYS_INLINE void springs_of_rows(const GridPotential& g, int row_begin, int row_end, double* energy) {
  for (int j = row_begin; j < row_end; ++j) {
    LaneSums<W> sum;
    float peak = 0;
    inertia_row<W>(g, j, sum);
    for (int family = 0; family < g.num_families; ++family) {
      const bool starts_here = j + kFamilyOffsets[family].rows < g.rows.num_rows;
      if (starts_here) spring_row<W, kStore, kDamped, kOwn>(g, family, j, sum, peak);
    }
    energy[j] = sum.total();
    if (g.limit.is_set()) g.peak[j] = peak;
  }
}

template <int W, bool kOwn>
WEFT_ALWAYS_INLINE void springs_of_rows(const GridPotential& g, bool store, int row_begin, int row_end,
                                        double* energy) {
  if (g.damping > 0 || g.damping_time > 0) {
    if (store) return springs_of_rows<W, true, true, kOwn>(g, row_begin, row_end, energy);
    return springs_of_rows<W, false, true, kOwn>(g, row_begin, row_end, energy);
  }
  if (store) return springs_of_rows<W, true, false, kOwn>(g, row_begin, row_end, energy);
  springs_of_rows<W, false, false, kOwn>(g, row_begin, row_end, energy);
}

template <int W>
WEFT_ALWAYS_INLINE void springs_body(const GridPotential& g, bool store, int row_begin, int row_end,
                                     double* energy) {
  if (g.own_stiffness) return springs_of_rows<W, true>(g, store, row_begin, row_end, energy);
  springs_of_rows<W, false>(g, store, row_begin, row_end, energy);
}

WEFT_MULTIVERSION_PACKS(springs,
                        (const GridPotential& g, bool store, int row_begin, int row_end, double* energy),
                        (g, store, row_begin, row_end, energy))

/// One component of the forces on row j.
template <int W>
WEFT_ALWAYS_INLINE void force_row(const GridPotential& g, int j, const float* x, const float* moved,
                                  const float* damped, float* force) {
  using V = Pack<W>;
  const int first = g.rows.row(j);
  const bool is_plain = g.damping > 0 && !g.is_projected;
  for_packs<W>(g.rows.row_length, [&](std::ptrdiff_t i, int) WEFT_INLINE_LAMBDA {
    const std::ptrdiff_t p = first + i;
    const V here = load<W>(x + p);
    V f = 0.0f - load<W>(g.weight + p) * load<W>(moved + p);
    for (int family = 0; family < g.num_families; ++family) {
      const FamilyOffset o = kFamilyOffsets[family];
      const int offset = o.rows * g.rows.stride() + o.columns;
      const float* own = g.slope + g.slope_row(j, family) + i;
      f += load<W>(own) * (load<W>(x + p + offset) - here) +
           load<W>(own - offset) * (load<W>(x + p - offset) - here);
    }
    if (is_plain) {
      const V z = load<W>(damped + p);
      for (int family = 0; family < g.num_families; ++family) {
        const FamilyOffset o = kFamilyOffsets[family];
        const int offset = o.rows * g.rows.stride() + o.columns;
        const bool starts = j + o.rows < g.rows.num_rows, ends = j >= o.rows;
        V sum = broadcast<W>(0);
        if (starts) sum += spring_exists<W>(g, family, i, j) * (load<W>(damped + p + offset) - z);
        if (ends)
          sum += spring_exists<W>(g, family, i - o.columns, j - o.rows) * (load<W>(damped + p - offset) - z);
        f += g.damping * sum;
      }
    }
    store(force + p, f);
  });
}

template <int W>
WEFT_ALWAYS_INLINE void forces_body(const GridPotential& g, int row_begin, int row_end) {
  for (int j = row_begin; j < row_end; ++j) {
    force_row<W>(g, j, g.x.x, g.offset.x, g.damped.x, g.force.x);
    force_row<W>(g, j, g.x.y, g.offset.y, g.damped.y, g.force.y);
    force_row<W>(g, j, g.x.z, g.offset.z, g.damped.z, g.force.z);
  }
}

WEFT_MULTIVERSION_PACKS(forces, (const GridPotential& g, int row_begin, int row_end), (g, row_begin, row_end))

WEFT_ALWAYS_INLINE void add_multi_body(const float* a, const float* b, float* sum, int begin, int end) {
  WEFT_IVDEP
  for (int i = begin; i < end; ++i) sum[i] = a[i] + b[i];
}

WEFT_MULTIVERSION(add_multi, (const float* a, const float* b, float* sum, int begin, int end),
                  (a, b, sum, begin, end))

/// Adds K (p_i − p_j) of the springs whose Hessian begins at h.
template <int W>
WEFT_ALWAYS_INLINE void add_product(const float* h, std::ptrdiff_t pitch, const Three<W>& a, ConstRows p,
                                    std::ptrdiff_t j, Three<W>& q) {
  using V = Pack<W>;
  const V t = load<W>(h), wx = load<W>(h + pitch), wy = load<W>(h + 2 * pitch), wz = load<W>(h + 3 * pitch);
  const V dx = a.x - load<W>(p.x + j), dy = a.y - load<W>(p.y + j), dz = a.z - load<W>(p.z + j);
  const V s = wx * dx + wy * dy + wz * dz;
  q.x += t * dx + wx * s;
  q.y += t * dy + wy * s;
  q.z += t * dz + wz * s;
}

template <int W, int kFamilies>
WEFT_ALWAYS_INLINE void multiply_rows(const GridPotential& g, ConstRows p, Rows q, int row_begin, int row_end,
                                      double* dot) {
  using V = Pack<W>;
  const std::ptrdiff_t pitch = g.rows.stride();
  for (int j = row_begin; j < row_end; ++j) {
    const std::ptrdiff_t first = g.rows.row(j);
    const float *h = g.hessian + g.hessian_row(j, 0, 0), *above = g.hessian + g.hessian_row(j - 1, 0, 0),
                *above2 = g.hessian + g.hessian_row(j - 2, 0, 0);
    LaneSums<W> sum;
    for_packs<W>(g.rows.row_length, [&](std::ptrdiff_t i, int part) WEFT_INLINE_LAMBDA {
      const std::ptrdiff_t c = first + i;
      const Three<W> a = load3<W>(p, c);
      const V d = load<W>(g.weight + c);
      Three<W> out{d * a.x, d * a.y, d * a.z};
      const auto both = [&](int family, const float* from, int rows, int columns) WEFT_INLINE_LAMBDA {
        const std::ptrdiff_t offset = rows * pitch + columns, plane = family * 4 * pitch + i;
        add_product<W>(h + plane, pitch, a, p, c + offset, out);
        add_product<W>(from + plane - columns, pitch, a, p, c - offset, out);
      };
      if (kFamilies > 0) {
        both(0, h, 0, 1);
        both(1, above, 1, 0);
        both(2, above, 1, 1);
        both(3, h, 0, 2);
        both(4, above2, 2, 0);
      }
      if (kFamilies == 6) both(5, above, 1, -1);
      store(q.x + c, out.x);
      store(q.y + c, out.y);
      store(q.z + c, out.z);
      sum.add(part, a.x * out.x + a.y * out.y + a.z * out.z);
    });
    dot[j] = sum.total();
  }
}

template <int W>
WEFT_ALWAYS_INLINE void multiply_body(const GridPotential& g, ConstRows p, Rows q, int row_begin, int row_end,
                                      double* dot) {
  if (g.num_families == 0) return multiply_rows<W, 0>(g, p, q, row_begin, row_end, dot);
  if (g.num_families == 6) return multiply_rows<W, 6>(g, p, q, row_begin, row_end, dot);
  multiply_rows<W, 5>(g, p, q, row_begin, row_end, dot);
}

WEFT_MULTIVERSION_PACKS(multiply,
                        (const GridPotential& g, ConstRows p, Rows q, int row_begin, int row_end,
                         double* dot),
                        (g, p, q, row_begin, row_end, dot))

}  // namespace

void add(const float* a, const float* b, float* sum, int begin, int end) { add_multi(a, b, sum, begin, end); }

void grid_springs(const GridPotential& g, bool store, int row_begin, int row_end, double* energy) {
  springs(g, store, row_begin, row_end, energy);
}

void grid_forces(const GridPotential& g, int row_begin, int row_end) { forces(g, row_begin, row_end); }

void grid_multiply(const GridPotential& g, ConstRows p, Rows q, int row_begin, int row_end, double* dot) {
  multiply(g, p, q, row_begin, row_end, dot);
}

}  // namespace weft::engine::kernels
