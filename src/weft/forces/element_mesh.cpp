/// Membranes and bending on any mesh. Sixteen triangles in parallel compute their frames and stresses. Then
/// sixteen particles in parallel gather over their edges, each of which has one or two triangles t (an edge
/// of more triangles has several entries), with the gradients g of its ends:
///
///     slope w = −A Σ_t g_i·S g_j      block N_ij = Σ_t |w_t| I − A (F Mᵗ Fᵀ)_t
///     M = [C11 gi1 gj1 + G gi2 gj2    C12 gi1 gj2 + G gi2 gj1]
///         [C12 gi2 gj1 + G gi1 gj2    C22 gi2 gj2 + G gi1 gj1]
///
/// Every edge is computed twice, once per end.

#include "weft/forces/element_block.h"

namespace weft::engine::kernels {
namespace {

constexpr int kLanes = kPackLanes;

/// Value k of the items of a slice, from a lane on.
constexpr std::ptrdiff_t place(int slice, int count, int k, int lane) {
  return (static_cast<std::ptrdiff_t>(slice) * count + k) * kLanes + lane;
}

template <int W>
WEFT_ALWAYS_INLINE Frame<W> frame_of(const MeshElements& m, int slice, int lane) {
  const Three<W> x0 = gather3<W>(m.x, m.first, m.corner + place(slice, 3, 0, lane));
  const Three<W> d1 = minus<W>(gather3<W>(m.x, m.first, m.corner + place(slice, 3, 1, lane)), x0);
  const Three<W> d2 = minus<W>(gather3<W>(m.x, m.first, m.corner + place(slice, 3, 2, lane)), x0);
  const float* shape = m.shape + place(slice, MeshElements::kShapeSize, 0, lane);
  return {plus<W>(times<W>(load<W>(shape), d1), times<W>(load<W>(shape + 2 * kLanes), d2)),
          plus<W>(times<W>(load<W>(shape + kLanes), d1), times<W>(load<W>(shape + 3 * kLanes), d2))};
}

/// Three rows of sixteen numbers.
WEFT_ALWAYS_INLINE Rows three_rows(float* from) { return {from, from + kLanes, from + 2 * kLanes}; }
WEFT_ALWAYS_INLINE ConstRows three_rows(const float* from) {
  return {from, from + kLanes, from + 2 * kLanes};
}

template <int W>
WEFT_ALWAYS_INLINE void past_body(const MeshElements& m, float share, int slice_begin, int slice_end) {
  for (int slice = slice_begin; slice < slice_end; ++slice) {
    for (int lane = 0; lane < kLanes; lane += W) {
      float* past = m.past + place(slice, 3, 0, lane);
      const Three<W> before = load3<W>({past, past + kLanes, past + 2 * kLanes}, 0);
      const Three<W> e = strain_of<W>(frame_of<W>(m, slice, lane));
      store3<W>(three_rows(past), 0, plus<W>(before, times<W>(share, e)));
    }
  }
}

WEFT_MULTIVERSION_PACKS(past, (const MeshElements& m, float share, int slice_begin, int slice_end),
                        (m, share, slice_begin, slice_end))

template <int W>
WEFT_ALWAYS_INLINE void membranes_body(const MeshElements& m, int slice_begin, int slice_end,
                                       double* energy) {
  for (int slice = slice_begin; slice < slice_end; ++slice) {
    LaneSums<W> sum;
    float peak = 0;
    for (int part = 0; part < kLanes / W; ++part) {
      const int lane = part * W;
      const Frame<W> f = frame_of<W>(m, slice, lane);
      const float* past = m.past + place(slice, 3, 0, lane);
      Three<W> e = strain_of<W>(f);
      if (m.damping > 0) e = minus<W>(e, load3<W>(three_rows(past), 0));
      Stress<W> s = stress_of<W>(m.membrane, e);
      const Pack<W> area = load<W>(m.shape + place(slice, MeshElements::kShapeSize, 4, lane));
      sum.add(part, 0.5f * area * twice_energy<W>(e, s));
      if (m.stiffening.is_set()) {
        const StiffeningAnswer<W> more = stiffening_answer<W>(m.stiffening, strain_of<W>(f));
        sum.add(part, area * more.energy);
        s = {s.s1 + more.stress.s1, s.s2 + more.stress.s2, s.s3 + more.stress.s3};
        store_tangent<W>(m.tangent + place(slice, kTangentSize, 0, lane), kLanes, more.tangent);
        const Pack<W> is_there = select_less(broadcast<W>(0), area, broadcast<W>(1), broadcast<W>(0));
        peak = larger(peak, widest<W>(is_there * more.peak));
      }
      float* frame = m.frame + place(slice, MeshElements::kFrameSize, 0, lane);
      store3<W>(three_rows(frame), 0, f.f1);
      store3<W>(three_rows(frame + 3 * kLanes), 0, f.f2);
      store3<W>(three_rows(frame + 6 * kLanes), 0, {s.s1, s.s2, s.s3});
    }
    if (m.stiffening.is_set()) m.peak[slice] = peak;
    energy[slice] = sum.total();
  }
}

WEFT_MULTIVERSION_PACKS(membranes, (const MeshElements& m, int slice_begin, int slice_end, double* energy),
                        (m, slice_begin, slice_end, energy))

/// ½ (|x_j − x_i|² + η |z_j − z_i|²) of a pack of neighbours.
template <int W>
WEFT_ALWAYS_INLINE Pack<W> half_square(const MeshElements& m, int at, const int* neighbour) {
  const Three<W> d = minus<W>(gather3<W>(m.x, m.first, neighbour), load3<W>(m.x, at));
  Pack<W> length_sq = dot<W>(d, d);
  if (m.damping > 0) {
    const Three<W> z = minus<W>(gather3<W>(m.damped, m.first, neighbour), load3<W>(m.damped, at));
    length_sq += m.damping * dot<W>(z, z);
  }
  return 0.5f * length_sq;
}

template <int W>
WEFT_ALWAYS_INLINE void bending_body(const MeshElements& m, int slice_begin, int slice_end, double* energy) {
  for (int slice = slice_begin; slice < slice_end; ++slice) {
    LaneSums<W> sum;
    for (int part = 0; part < kLanes / W; ++part) {
      const int lane = part * W, at = m.first + slice * kLanes + lane;
      for (int row = m.slice_begin[slice]; row < m.slice_begin[slice + 1]; ++row) {
        const Pack<W> b = load<W>(m.entry + place(row, MeshElements::kEntrySize, 8, lane));
        sum.add(part, 0.5f * b * half_square<W>(m, at, m.neighbour + row * kLanes + lane));
      }
      for (int row = m.far_begin[slice]; row < m.far_begin[slice + 1]; ++row) {
        const Pack<W> b = load<W>(m.far_bending + row * kLanes + lane);
        sum.add(part, 0.5f * b * half_square<W>(m, at, m.far_neighbour + row * kLanes + lane));
      }
    }
    energy[slice] = sum.total();
  }
}

WEFT_MULTIVERSION_PACKS(bending, (const MeshElements& m, int slice_begin, int slice_end, double* energy),
                        (m, slice_begin, slice_end, energy))

/// Stiffening in a triangle's block, with gradients i and j: a = i1 j1, b = i2 j2, c = i1 j2, d = i2 j1.
template <int W>
WEFT_ALWAYS_INLINE void add_stiffening(const MeshElements& m, const int* triangle, const Frame<W>& f,
                                       Pack<W> a, Pack<W> b, Pack<W> c, Pack<W> d, Block<W>& block) {
  int at[W];
  for (int l = 0; l < W; ++l) at[l] = triangle[l] / kLanes * (kTangentSize * kLanes) + triangle[l] % kLanes;
  const auto number = [&](int k) WEFT_INLINE_LAMBDA { return gather<W>(m.tangent + k * kLanes, at); };
  const Pack<W> d13 = number(2), d23 = number(4), d33 = number(5), both = c + d, own = d13 * a + d23 * b;
  block.add(f, 0.0f - (number(0) * a + d33 * b + d13 * both), 0.0f - (number(3) * b + d33 * a + d23 * both),
            0.0f - (number(1) * c + d33 * d + own), 0.0f - (number(1) * d + d33 * c + own));
}

/// Adds the contribution of triangle `which` of an entry to its slope and block.
template <int W>
WEFT_ALWAYS_INLINE void add_triangle(const MeshElements& m, int row, int lane, int which, Pack<W>& slope,
                                     Block<W>& block) {
  const int* triangle = m.triangle + place(row, 2, which, lane);
  int at[W];
  for (int l = 0; l < W; ++l)
    at[l] = triangle[l] / kLanes * (MeshElements::kFrameSize * kLanes) + triangle[l] % kLanes;
  const auto frame3 = [&](int k) WEFT_INLINE_LAMBDA {
    return gather3<W>(three_rows(static_cast<const float*>(m.frame) + k * kLanes), 0, at);
  };
  const Frame<W> f{frame3(0), frame3(3)};
  const Three<W> s = frame3(6);
  const float* entry = m.entry + place(row, MeshElements::kEntrySize, 4 * which, lane);
  const Pack<W> i1 = load<W>(entry), i2 = load<W>(entry + kLanes);
  const Pack<W> j1 = load<W>(entry + 2 * kLanes), j2 = load<W>(entry + 3 * kLanes);
  const Pack<W> a = i1 * j1, b = i2 * j2, c = i1 * j2, d = i2 * j1;
  const Pack<W> w = 0.0f - (a * s.x + b * s.y + (c + d) * s.z);
  slope += w;
  block.add_diagonal(magnitude(w));
  const MembraneNumbers& n = m.membrane;
  block.add(f, 0.0f - (n.c11 * a + n.g * b), 0.0f - (n.c22 * b + n.g * a), 0.0f - (n.c12 * c + n.g * d),
            0.0f - (n.c12 * d + n.g * c));
  if (m.stiffening.is_set()) add_stiffening<W>(m, triangle, f, a, b, c, d, block);
}

template <int W>
WEFT_ALWAYS_INLINE void blocks_of_pack(const MeshElements& m, int slice, int lane) {
  const int at = m.first + slice * kLanes + lane;
  const Three<W> x = load3<W>(m.x, at), bent = load3<W>(m.bent, at);
  Three<W> force = load3<W>({m.force.x, m.force.y, m.force.z}, at);
  for (int row = m.slice_begin[slice]; row < m.slice_begin[slice + 1]; ++row) {
    const int* neighbour = m.neighbour + row * kLanes + lane;
    Pack<W> slope = broadcast<W>(0);
    Block<W> block;
    add_triangle<W>(m, row, lane, 0, slope, block);
    add_triangle<W>(m, row, lane, 1, slope, block);
    const Pack<W> b = load<W>(m.entry + place(row, MeshElements::kEntrySize, 8, lane));
    block.add_diagonal((1 + m.damping) * b);
    block.store_at(m.hessian + place(row, kBlockSize, 0, lane), kLanes);
    force = plus<W>(force, times<W>(slope, minus<W>(gather3<W>(m.x, m.first, neighbour), x)));
    force = plus<W>(force, times<W>(b, minus<W>(gather3<W>(m.bent, m.first, neighbour), bent)));
  }
  for (int row = m.far_begin[slice]; row < m.far_begin[slice + 1]; ++row) {
    const Pack<W> b = load<W>(m.far_bending + row * kLanes + lane);
    const Three<W> there = gather3<W>(m.bent, m.first, m.far_neighbour + row * kLanes + lane);
    force = plus<W>(force, times<W>(b, minus<W>(there, bent)));
  }
  store3<W>(m.force, at, force);
}

template <int W>
WEFT_ALWAYS_INLINE void blocks_body(const MeshElements& m, int slice_begin, int slice_end) {
  for (int slice = slice_begin; slice < slice_end; ++slice) {
    for (int lane = 0; lane < kLanes; lane += W) blocks_of_pack<W>(m, slice, lane);
  }
}

WEFT_MULTIVERSION_PACKS(blocks, (const MeshElements& m, int slice_begin, int slice_end),
                        (m, slice_begin, slice_end))

template <int W>
WEFT_ALWAYS_INLINE Three<W> product_of_pack(const MeshElements& m, ConstRows p, const Three<W>& a, int slice,
                                            int lane) {
  Three<W> out = {}, far = {};
  for (int row = m.slice_begin[slice]; row < m.slice_begin[slice + 1]; ++row) {
    const Three<W> d = minus<W>(a, gather3<W>(p, m.first, m.neighbour + row * kLanes + lane));
    add_product<W>(m.hessian + place(row, kBlockSize, 0, lane), kLanes, d, out);
  }
  for (int row = m.far_begin[slice]; row < m.far_begin[slice + 1]; ++row) {
    const Three<W> d = minus<W>(a, gather3<W>(p, m.first, m.far_neighbour + row * kLanes + lane));
    far = plus<W>(far, times<W>(load<W>(m.far_bending + row * kLanes + lane), d));
  }
  return plus<W>(out, times<W>(1 + m.damping, far));
}

template <int W>
WEFT_ALWAYS_INLINE void multiply_body(const MeshElements& m, ConstRows p, Rows q, int slice_begin,
                                      int slice_end, double* dots) {
  for (int slice = slice_begin; slice < slice_end; ++slice) {
    LaneSums<W> sum;
    for (int part = 0; part < kLanes / W; ++part) {
      const int lane = part * W, at = m.first + slice * kLanes + lane;
      const Three<W> a = load3<W>(p, at);
      const Three<W> out = product_of_pack<W>(m, p, a, slice, lane);
      store3<W>(q, at, plus<W>(load3<W>({q.x, q.y, q.z}, at), out));
      sum.add(part, dot<W>(a, out));
    }
    dots[slice] = sum.total();
  }
}

WEFT_MULTIVERSION_PACKS(multiply,
                        (const MeshElements& m, ConstRows p, Rows q, int slice_begin, int slice_end,
                         double* dots),
                        (m, p, q, slice_begin, slice_end, dots))

}  // namespace

void mesh_past(const MeshElements& m, float share, int slice_begin, int slice_end) {
  past(m, share, slice_begin, slice_end);
}

void mesh_membranes(const MeshElements& m, int slice_begin, int slice_end, double* energy) {
  membranes(m, slice_begin, slice_end, energy);
}

void mesh_bending(const MeshElements& m, int slice_begin, int slice_end, double* energy) {
  bending(m, slice_begin, slice_end, energy);
}

void mesh_blocks(const MeshElements& m, int slice_begin, int slice_end) { blocks(m, slice_begin, slice_end); }

void mesh_multiply_elements(const MeshElements& m, ConstRows p, Rows q, int slice_begin, int slice_end,
                            double* dot) {
  multiply(m, p, q, slice_begin, slice_end, dot);
}

}  // namespace weft::engine::kernels
