/// The incremental potential on any mesh: each particle gathers over its row of the NeighbourTable, sixteen
/// particles in parallel. Every spring is computed twice, once per end.

#include <algorithm>

#include "weft/forces/pack3.h"
#include "weft/forces/potential_kernels.h"

namespace weft::engine::kernels {
namespace {

constexpr int kLanes = NeighbourTable::kLanes;
constexpr float kMinLengthSq = 1e-30f;

static_assert(kLanes == kPackLanes);

/// Springs of W particles, from lane `lane` of a slice on.
template <int W, bool kStore, bool kDamped>
WEFT_ALWAYS_INLINE void springs_of_pack(const MeshPotential& m, int slice, int lane, int part,
                                        LaneSums<W>& energy) {
  using V = Pack<W>;
  const int p = m.first + slice * kLanes + lane;
  const Three<W> x = load3<W>(m.x, p), e = load3<W>(m.offset, p);
  const V weight = load<W>(m.weight + p);
  energy.add(part, 0.5f * weight * dot<W>(e, e));
  Three<W> force{0.0f - weight * e.x, 0.0f - weight * e.y, 0.0f - weight * e.z};
  for (int row = m.table->slice_begin[slice]; row < m.table->slice_begin[slice + 1]; ++row) {
    const int entry = row * kLanes + lane;
    const int* neighbour = m.table->neighbour.data() + entry;
    const Three<W> d = minus<W>(gather3<W>(m.x, m.first, neighbour), x);
    const V length = square_root(larger(dot<W>(d, d), broadcast<W>(kMinLengthSq))), inverse = 1.0f / length;
    const V k = load<W>(m.stiffness + entry),
            extension = length - load<W>(m.table->rest_length.data() + entry);
    const V elastic = k * extension * inverse;
    V slope = elastic, axial = broadcast<W>(0), plain = broadcast<W>(0);
    energy.add(part, 0.25f * k * extension * extension);
    if (kDamped) {
      const Three<W> z = minus<W>(gather3<W>(m.damped, m.first, neighbour), load3<W>(m.damped, p));
      const V c = select_less(broadcast<W>(0), load<W>(m.table->rest_length.data() + entry),
                              broadcast<W>(m.damping), broadcast<W>(0)) +
                  m.damping_time * k;
      if (m.is_projected) {
        const V along = dot<W>(z, d) * inverse;
        energy.add(part, 0.25f * c * along * along);
        slope += c * along * inverse;
        axial = c;
      } else {
        energy.add(part, 0.25f * c * dot<W>(z, z));
        force = {force.x + c * z.x, force.y + c * z.y, force.z + c * z.z};
        plain = c;
      }
    }
    if (kStore) {
      force = {force.x + slope * d.x, force.y + slope * d.y, force.z + slope * d.z};
      const V t = smaller(k, magnitude(elastic)), w = square_root((k - t) + axial) * inverse;
      float* h = m.hessian + 4 * row * kLanes + lane;
      store(h, t + plain);
      store(h + kLanes, w * d.x);
      store(h + 2 * kLanes, w * d.y);
      store(h + 3 * kLanes, w * d.z);
    }
  }
  if (kStore) {
    store(m.force.x + p, force.x);
    store(m.force.y + p, force.y);
    store(m.force.z + p, force.z);
  }
}

template <int W, bool kStore, bool kDamped>
WEFT_ALWAYS_INLINE void springs_of_slices(const MeshPotential& m, int slice_begin, int slice_end,
                                          double* energy) {
  for (int slice = slice_begin; slice < slice_end; ++slice) {
    LaneSums<W> sum;
    for (int part = 0; part < kLanes / W; ++part)
      springs_of_pack<W, kStore, kDamped>(m, slice, part * W, part, sum);
    energy[slice] = sum.total();
  }
}

template <int W>
WEFT_ALWAYS_INLINE void springs_body(const MeshPotential& m, bool store, int slice_begin, int slice_end,
                                     double* energy) {
  if (m.damping > 0 || m.damping_time > 0) {
    if (store) return springs_of_slices<W, true, true>(m, slice_begin, slice_end, energy);
    return springs_of_slices<W, false, true>(m, slice_begin, slice_end, energy);
  }
  if (store) return springs_of_slices<W, true, false>(m, slice_begin, slice_end, energy);
  springs_of_slices<W, false, false>(m, slice_begin, slice_end, energy);
}

WEFT_MULTIVERSION_PACKS(springs,
                        (const MeshPotential& m, bool store, int slice_begin, int slice_end, double* energy),
                        (m, store, slice_begin, slice_end, energy))

template <int W>
WEFT_ALWAYS_INLINE void multiply_body(const MeshPotential& m, ConstRows p, Rows q, int slice_begin,
                                      int slice_end, double* result) {
  using V = Pack<W>;
  for (int slice = slice_begin; slice < slice_end; ++slice) {
    LaneSums<W> sum;
    for (int part = 0; part < kLanes / W; ++part) {
      const int lane = part * W, c = m.first + slice * kLanes + lane;
      const Three<W> a = load3<W>(p, c);
      const V weight = load<W>(m.weight + c);
      Three<W> out{weight * a.x, weight * a.y, weight * a.z};
      for (int row = m.table->slice_begin[slice]; row < m.table->slice_begin[slice + 1]; ++row) {
        const Three<W> d =
            minus<W>(a, gather3<W>(p, m.first, m.table->neighbour.data() + row * kLanes + lane));
        const float* h = m.hessian + 4 * row * kLanes + lane;
        const V t = load<W>(h);
        const Three<W> w{load<W>(h + kLanes), load<W>(h + 2 * kLanes), load<W>(h + 3 * kLanes)};
        const V s = dot<W>(w, d);
        out = {out.x + (t * d.x + w.x * s), out.y + (t * d.y + w.y * s), out.z + (t * d.z + w.z * s)};
      }
      store(q.x + c, out.x);
      store(q.y + c, out.y);
      store(q.z + c, out.z);
      sum.add(part, dot<W>(a, out));
    }
    result[slice] = sum.total();
  }
}

WEFT_MULTIVERSION_PACKS(multiply,
                        (const MeshPotential& m, ConstRows p, Rows q, int slice_begin, int slice_end,
                         double* result),
                        (m, p, q, slice_begin, slice_end, result))

}  // namespace

void mesh_springs(const MeshPotential& m, bool store, int slice_begin, int slice_end, double* energy) {
  springs(m, store, slice_begin, slice_end, energy);
}

void mesh_multiply(const MeshPotential& m, ConstRows p, Rows q, int slice_begin, int slice_end,
                   double* result) {
  multiply(m, p, q, slice_begin, slice_end, result);
}

}  // namespace weft::engine::kernels
