/// Membranes and bending on any mesh. Sixteen patches in parallel compute their frames, strains and stresses, and
/// then a slope and a block for each two of their vertices. Then sixteen particles in parallel gather those of their
/// edges, each of which is in one or two patches (an edge of more has several entries). With the gradients g of a
/// triangle t and the derivatives D of the mean strain, B of the difference:
///
///     slope w = −Σ_t A_t g_i·S_t g_j      block N_ij = Σ_t |w_t| I − A D_iᵀ C D_j − a B_iᵀ C' B_j

#include "weft/forces/element_block.h"

namespace weft::engine::kernels {
namespace {

constexpr int kLanes = kPackLanes;

/// Value k of the items of a slice, from a lane on.
constexpr std::ptrdiff_t place(int slice, int count, int k, int lane) {
  return (static_cast<std::ptrdiff_t>(slice) * count + k) * kLanes + lane;
}

/// The frames of a patch's triangles.
template <int W>
struct Frames {
  Frame<W> first, second;
};

template <int W>
WEFT_ALWAYS_INLINE Frame<W> frame_of(const float* shape, const Three<W>& d, const Three<W>& e) {
  return {plus<W>(times<W>(load<W>(shape), d), times<W>(load<W>(shape + 2 * kLanes), e)),
          plus<W>(times<W>(load<W>(shape + kLanes), d), times<W>(load<W>(shape + 3 * kLanes), e))};
}

template <int W>
WEFT_ALWAYS_INLINE Frames<W> frames_of(const MeshElements& m, int slice, int lane) {
  const auto corner = [&](int k) WEFT_INLINE_LAMBDA {
    return gather3<W>(m.x, m.first, m.corner + place(slice, 4, k, lane));
  };
  const Three<W> x0 = corner(0), d1 = minus<W>(corner(1), x0);
  const float* shape = m.shape + place(slice, MeshElements::kShapeSize, 0, lane);
  return {frame_of<W>(shape, d1, minus<W>(corner(2), x0)),
          frame_of<W>(shape + 4 * kLanes, d1, minus<W>(corner(3), x0))};
}

/// Shares of both triangles in the patch's area, the area, and that of the difference.
template <int W>
struct Areas {
  Pack<W> share_1, share_2, all, difference;
};

template <int W>
WEFT_ALWAYS_INLINE Areas<W> areas_of(const MeshElements& m, int slice, int lane) {
  const float* area = m.shape + place(slice, MeshElements::kShapeSize, 8, lane);
  const Pack<W> a = load<W>(area), b = load<W>(area + kLanes), inverse = load<W>(area + 2 * kLanes);
  return {a * inverse, b * inverse, a + b, a * b * inverse};
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
      float* past = m.past + place(slice, 6, 0, lane);
      const Frames<W> f = frames_of<W>(m, slice, lane);
      const auto add = [&](float* to, const Frame<W>& frame) WEFT_INLINE_LAMBDA {
        const Three<W> before = load3<W>({to, to + kLanes, to + 2 * kLanes}, 0);
        store3<W>(three_rows(to), 0, plus<W>(before, times<W>(share, strain_of<W>(frame))));
      };
      add(past, f.first);
      add(past + 3 * kLanes, f.second);
    }
  }
}

WEFT_MULTIVERSION_PACKS(past, (const MeshElements& m, float share, int slice_begin, int slice_end),
                        (m, share, slice_begin, slice_end))

template <int W>
WEFT_ALWAYS_INLINE Three<W> mean_of(const Areas<W>& areas, const Three<W>& first, const Three<W>& second) {
  return plus<W>(times<W>(areas.share_1, first), times<W>(areas.share_2, second));
}

/// Adds the response of a thread to a large difference; returns its energy.
template <int W>
WEFT_ALWAYS_INLINE Pack<W> add_large_difference(Pack<W> difference, float begin, float stiffness,
                                                Pack<W>& stress, Pack<W>& tangent) {
  const Pack<W> zero = broadcast<W>(0), beyond = larger(magnitude(difference) - begin, zero);
  const Pack<W> rise = stiffness * beyond;
  stress += select_less(difference, zero, 0.0f - rise, rise);
  tangent = select_less(zero, beyond, broadcast<W>(stiffness), zero);
  return 0.5f * rise * beyond;
}

template <int W>
WEFT_ALWAYS_INLINE void membranes_body(const MeshElements& m, int slice_begin, int slice_end,
                                       double* energy) {
  for (int slice = slice_begin; slice < slice_end; ++slice) {
    LaneSums<W> sum;
    float peak = 0;
    for (int part = 0; part < kLanes / W; ++part) {
      const int lane = part * W;
      const Frames<W> f = frames_of<W>(m, slice, lane);
      const Areas<W> areas = areas_of<W>(m, slice, lane);
      const Three<W> e1 = strain_of<W>(f.first), e2 = strain_of<W>(f.second);
      Three<W> mean = mean_of<W>(areas, e1, e2), difference = minus<W>(e1, e2);
      const Three<W> pure_mean = mean, pure_difference = difference;
      if (m.damping > 0) {
        const float* past = m.past + place(slice, 6, 0, lane);
        const Three<W> past1 = load3<W>(three_rows(past), 0),
                       past2 = load3<W>(three_rows(past + 3 * kLanes), 0);
        mean = minus<W>(mean, mean_of<W>(areas, past1, past2));
        difference = minus<W>(difference, minus<W>(past1, past2));
      }
      Stress<W> s = stress_of<W>(m.membrane, mean);
      sum.add(part, 0.5f * areas.all * twice_energy<W>(mean, s));
      Three<W> t = times<W>(m.difference.soft, difference);
      sum.add(part, 0.5f * areas.difference * dot<W>(difference, t));
      Pack<W> tangent_1, tangent_2;
      const Pack<W> large = add_large_difference<W>(pure_difference.x, m.difference.begin,
                                                    m.difference.along_1, t.x, tangent_1) +
                            add_large_difference<W>(pure_difference.y, m.difference.begin,
                                                    m.difference.along_2, t.y, tangent_2);
      sum.add(part, areas.difference * large);
      Stress<W> limit1{}, limit2{};
      if (m.stiffening.is_set()) {
        float* tangent = m.tangent + place(slice, MeshElements::kTangents, 0, lane);
        Pack<W> of_curves = broadcast<W>(0), d1 = broadcast<W>(0), d2 = broadcast<W>(0);
        add_curve<W>(m.stiffening.along_1, pure_mean.x, of_curves, s.s1, d1);
        add_curve<W>(m.stiffening.along_2, pure_mean.y, of_curves, s.s2, d2);
        store(tangent, d1);
        store(tangent + kLanes, d2);
        sum.add(part, areas.all * of_curves);
        const auto limit = [&](const Three<W>& e, Pack<W> area, float* to) WEFT_INLINE_LAMBDA {
          StiffeningAnswer<W> answer{};
          if (m.stiffening.limit.is_set()) answer = limit_answer<W>(m.stiffening.limit, e);
          sum.add(part, area * answer.energy);
          store_tangent<W>(to, kLanes, answer.tangent);
          const Pack<W> is_there = select_less(broadcast<W>(0), area, broadcast<W>(1), broadcast<W>(0));
          peak = larger(peak, widest<W>(is_there * answer.peak));
          return answer.stress;
        };
        limit1 = limit(e1, areas.share_1 * areas.all, tangent + 2 * kLanes);
        limit2 = limit(e2, areas.share_2 * areas.all, tangent + (2 + kTangentSize) * kLanes);
      }
      float* frame = m.frame + place(slice, MeshElements::kFrameSize, 0, lane);
      store3<W>(three_rows(frame), 0, f.first.f1);
      store3<W>(three_rows(frame + 3 * kLanes), 0, f.first.f2);
      store3<W>(three_rows(frame + 6 * kLanes), 0, f.second.f1);
      store3<W>(three_rows(frame + 9 * kLanes), 0, f.second.f2);
      const Three<W> mean_stress{s.s1, s.s2, s.s3};
      const auto with = [](const Three<W>& stress, const Stress<W>& limit) WEFT_INLINE_LAMBDA {
        return Three<W>{stress.x + limit.s1, stress.y + limit.s2, stress.z + limit.s3};
      };
      store3<W>(three_rows(frame + 12 * kLanes), 0,
                with(plus<W>(mean_stress, times<W>(areas.share_2, t)), limit1));
      store3<W>(three_rows(frame + 15 * kLanes), 0,
                with(minus<W>(mean_stress, times<W>(areas.share_1, t)), limit2));
      store(frame + 18 * kLanes, tangent_1);
      store(frame + 19 * kLanes, tangent_2);
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
        const Pack<W> b = load<W>(m.bending + row * kLanes + lane);
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

/// A vertex's gradient in a triangle.
template <int W>
struct Gradient {
  Pack<W> x, y;
};

/// Derivative of three strains by a vertex: three rows.
template <int W>
struct Derivative {
  Three<W> row[3];
};

template <int W>
WEFT_ALWAYS_INLINE Derivative<W> derivative_of(const Frame<W>& f, const Gradient<W>& g) {
  return {{times<W>(g.x, f.f1), times<W>(g.y, f.f2), plus<W>(times<W>(g.y, f.f1), times<W>(g.x, f.f2))}};
}

/// a A + b B
template <int W, class S>
WEFT_ALWAYS_INLINE Derivative<W> sum_of(S a, const Derivative<W>& first, S b, const Derivative<W>& second) {
  Derivative<W> sum;
  for (int r = 0; r < 3; ++r) sum.row[r] = plus<W>(times<W>(a, first.row[r]), times<W>(b, second.row[r]));
  return sum;
}

/// Rows of the symmetric tangent times those of the derivative.
template <int W>
WEFT_ALWAYS_INLINE Derivative<W> multiply_tangent(const Tangent<W>& k, const Derivative<W>& d) {
  const auto row = [&](Pack<W> a, Pack<W> b, Pack<W> c) WEFT_INLINE_LAMBDA {
    return plus<W>(plus<W>(times<W>(a, d.row[0]), times<W>(b, d.row[1])), times<W>(c, d.row[2]));
  };
  return {{row(k.d11, k.d12, k.d13), row(k.d12, k.d22, k.d23), row(k.d13, k.d23, k.d33)}};
}

/// block −= Aᵀ B
template <int W>
WEFT_ALWAYS_INLINE void subtract_product(const Derivative<W>& a, const Derivative<W>& b, Block<W>& block) {
  for (int s = 0; s < 3; ++s) {
    block.row[0] = minus<W>(block.row[0], times<W>(a.row[s].x, b.row[s]));
    block.row[1] = minus<W>(block.row[1], times<W>(a.row[s].y, b.row[s]));
    block.row[2] = minus<W>(block.row[2], times<W>(a.row[s].z, b.row[s]));
  }
}

/// block −= A Bᵀ L B of a triangle's limit.
template <int W>
WEFT_ALWAYS_INLINE void subtract_limit(const float* tangent, Pack<W> area, const Derivative<W>& i,
                                       const Derivative<W>& j, Block<W>& block) {
  Derivative<W> pull = multiply_tangent<W>(load_tangent<W>(tangent, kLanes), j);
  for (int r = 0; r < 3; ++r) pull.row[r] = times<W>(area, pull.row[r]);
  subtract_product<W>(i, pull, block);
}

/// −A g_i·S g_j
template <int W>
WEFT_ALWAYS_INLINE Pack<W> slope_of(Pack<W> area, const Three<W>& s, const Gradient<W>& i,
                                    const Gradient<W>& j) {
  return (0.0f - area) * (i.x * (s.x * j.x + s.z * j.y) + i.y * (s.z * j.x + s.y * j.y));
}

template <int W>
WEFT_ALWAYS_INLINE void patches_of_pack(const MeshElements& m, int slice, int lane) {
  const float* shape = m.shape + place(slice, MeshElements::kShapeSize, 0, lane);
  const float* frame = m.frame + place(slice, MeshElements::kFrameSize, 0, lane);
  const auto gradient = [&](int k) WEFT_INLINE_LAMBDA {
    return Gradient<W>{load<W>(shape + k * kLanes), load<W>(shape + (k + 1) * kLanes)};
  };
  const auto frame3 = [&](int k) WEFT_INLINE_LAMBDA { return load3<W>(three_rows(frame + k * kLanes), 0); };
  const Pack<W> zero = broadcast<W>(0);
  const Gradient<W> a1 = gradient(0), a2 = gradient(2), b1 = gradient(4), b3 = gradient(6), none{zero, zero};
  const Gradient<W> first[4] = {{0.0f - a1.x - a2.x, 0.0f - a1.y - a2.y}, a1, a2, none};
  const Gradient<W> second[4] = {{0.0f - b1.x - b3.x, 0.0f - b1.y - b3.y}, b1, none, b3};
  const Frame<W> f1{frame3(0), frame3(3)}, f2{frame3(6), frame3(9)};
  const Three<W> s1 = frame3(12), s2 = frame3(15);
  const Areas<W> areas = areas_of<W>(m, slice, lane);
  const Pack<W> area_1 = areas.share_1 * areas.all, area_2 = areas.share_2 * areas.all;

  const MembraneNumbers& c = m.membrane;
  Tangent<W> k{broadcast<W>(c.c11), broadcast<W>(c.c12), zero, broadcast<W>(c.c22), zero, broadcast<W>(c.g)};
  const float* tangent = m.tangent + place(slice, MeshElements::kTangents, 0, lane);
  if (m.stiffening.is_set()) {
    k.d11 += load<W>(tangent);
    k.d22 += load<W>(tangent + kLanes);
  }
  const Pack<W> stiff[3] = {m.difference.soft + load<W>(frame + 18 * kLanes),
                            m.difference.soft + load<W>(frame + 19 * kLanes),
                            broadcast<W>(m.difference.soft)};
  Derivative<W> own[4], other[4];  // of both triangles' strains
  Derivative<W> mean[4], pull[4], apart[4],
      resist[4];  // of mean and difference, and their stresses times areas
  for (int v = 0; v < 4; ++v) {
    own[v] = derivative_of<W>(f1, first[v]);
    other[v] = derivative_of<W>(f2, second[v]);
    mean[v] = sum_of<W>(areas.share_1, own[v], areas.share_2, other[v]);
    apart[v] = sum_of<W>(1.0f, own[v], -1.0f, other[v]);
    pull[v] = multiply_tangent<W>(k, mean[v]);
    for (int r = 0; r < 3; ++r) {
      pull[v].row[r] = times<W>(areas.all, pull[v].row[r]);
      resist[v].row[r] = times<W>(areas.difference * stiff[r], apart[v].row[r]);
    }
  }
  float* to = m.patch + place(slice, MeshElements::kPatchSize, 0, lane);
  for (int i = 0; i < 3; ++i) {
    for (int j = i + 1; j < 4; ++j) {
      const Pack<W> w1 = slope_of<W>(area_1, s1, first[i], first[j]),
                    w2 = slope_of<W>(area_2, s2, second[i], second[j]);
      Block<W> block;
      block.add_diagonal(magnitude(w1) + magnitude(w2));
      subtract_product<W>(mean[i], pull[j], block);
      subtract_product<W>(apart[i], resist[j], block);
      if (m.stiffening.limit.is_set()) {
        subtract_limit<W>(tangent + 2 * kLanes, area_1, own[i], own[j], block);
        subtract_limit<W>(tangent + (2 + kTangentSize) * kLanes, area_2, other[i], other[j], block);
      }
      store(to, w1 + w2);
      block.store_at(to + kLanes, kLanes);
      to += MeshElements::kCouplingSize * kLanes;
    }
  }
}

template <int W>
WEFT_ALWAYS_INLINE void patches_body(const MeshElements& m, int slice_begin, int slice_end) {
  for (int slice = slice_begin; slice < slice_end; ++slice) {
    for (int lane = 0; lane < kLanes; lane += W) patches_of_pack<W>(m, slice, lane);
  }
}

WEFT_MULTIVERSION_PACKS(patches, (const MeshElements& m, int slice_begin, int slice_end),
                        (m, slice_begin, slice_end))

/// Adds coupling `which` of an entry to its slope and block.
template <int W>
WEFT_ALWAYS_INLINE void add_coupling(const MeshElements& m, int row, int lane, int which, Pack<W>& slope,
                                     Block<W>& block) {
  const int* coupling = m.coupling + place(row, 2, which, lane);
  int at[W], along[W], down[W];  // steps to the next number of a row and of a column
  for (int l = 0; l < W; ++l) {
    const bool is_turned = coupling[l] % 2 == 1;
    at[l] = coupling[l] / 2;
    along[l] = (is_turned ? 3 : 1) * kLanes;
    down[l] = (is_turned ? 1 : 3) * kLanes;
  }
  slope += gather<W>(m.patch, at);
  const auto number = [&](int r, int c) WEFT_INLINE_LAMBDA {
    Pack<W> v{};
    for (int l = 0; l < W; ++l) v[l] = m.patch[at[l] + kLanes + r * down[l] + c * along[l]];
    return v;
  };
  for (int r = 0; r < 3; ++r)
    block.row[r] = plus<W>(block.row[r], Three<W>{number(r, 0), number(r, 1), number(r, 2)});
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
    add_coupling<W>(m, row, lane, 0, slope, block);
    add_coupling<W>(m, row, lane, 1, slope, block);
    const Pack<W> b = load<W>(m.bending + row * kLanes + lane);
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

void mesh_patches(const MeshElements& m, int slice_begin, int slice_end) {
  patches(m, slice_begin, slice_end);
}

void mesh_blocks(const MeshElements& m, int slice_begin, int slice_end) { blocks(m, slice_begin, slice_end); }

void mesh_multiply_elements(const MeshElements& m, ConstRows p, Rows q, int slice_begin, int slice_end,
                            double* dot) {
  multiply(m, p, q, slice_begin, slice_end, dot);
}

}  // namespace weft::engine::kernels
