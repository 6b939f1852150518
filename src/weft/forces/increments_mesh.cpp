/// Springs of any mesh: each particle gathers over its row of the NeighbourTable, sixteen particles in
/// parallel.

#include <algorithm>

#include "weft/forces/increments_kernels.h"

namespace weft::engine::kernels {
namespace {

constexpr int kLanes = NeighbourTable::kLanes;

struct MeshSlicesArguments {
  const NeighbourTable& table;
  const float* stiffness;
  int num_particles;
  const Forcing& forcing;
  ConstRows x, v;
  const float *mass, *weight;
  Rows u;
  int slice_begin, slice_end;
};

template <bool kProjected>
WEFT_ALWAYS_INLINE void mesh_slices_impl(const MeshSlicesArguments& a) {
  const float *x = a.x.x, *y = a.x.y, *z = a.x.z, *vx = a.v.x, *vy = a.v.y, *vz = a.v.z;
  const float plain = a.forcing.damping_plain, b = a.forcing.damping_projected,
              tau = a.forcing.stiffness_damping;
  const float rate = a.forcing.wind_rate, step = a.forcing.step;
  for (int slice = a.slice_begin; slice < a.slice_end; ++slice) {
    const int first = slice * kLanes;
    alignas(64) float fx[kLanes] = {}, fy[kLanes] = {}, fz[kLanes] = {};
    for (int row = a.table.slice_begin[slice]; row < a.table.slice_begin[slice + 1]; ++row) {
      const int* neighbour = a.table.neighbour.data() + row * kLanes;
      const float* rest_length = a.table.rest_length.data() + row * kLanes;
      const float* stiffness = a.stiffness + row * kLanes;
      WEFT_IVDEP
      for (int lane = 0; lane < kLanes; ++lane) {
        const int i = first + lane, j = neighbour[lane];
        const float k = stiffness[lane], c = plain + tau * k;
        const float dx = x[j] - x[i], dy = y[j] - y[i], dz = z[j] - z[i];
        const float wx = vx[j] - vx[i], wy = vy[j] - vy[i], wz = vz[j] - vz[i];
        const float s = pull<kProjected>(k, rest_length[lane], b, dx, dy, dz, wx, wy, wz);
        fx[lane] += s * dx + c * wx;
        fy[lane] += s * dy + c * wy;
        fz[lane] += s * dz + c * wz;
      }
    }
    const int count = std::min(kLanes, a.num_particles - first);
    const float *mass = a.mass + first, *weight = a.weight + first;
    const float ax = a.forcing.ax, ay = a.forcing.ay, az = a.forcing.az;
    WEFT_IVDEP
    for (int lane = 0; lane < count; ++lane) {
      const int i = first + lane;
      const float hw = step * weight[lane];
      a.u.x[i] = hw * (fx[lane] + mass[lane] * (ax - rate * vx[i]));
      a.u.y[i] = hw * (fy[lane] + mass[lane] * (ay - rate * vy[i]));
      a.u.z[i] = hw * (fz[lane] + mass[lane] * (az - rate * vz[i]));
    }
  }
}

WEFT_ALWAYS_INLINE void mesh_slices_body(const MeshSlicesArguments& a) {
  if (a.forcing.damping_projected != 0) return mesh_slices_impl<true>(a);
  mesh_slices_impl<false>(a);
}

WEFT_MULTIVERSION(mesh_slices, (const MeshSlicesArguments& a), (a))

struct MeshFilteredArguments {
  const NeighbourTable& table;
  const float* stiffness;
  int num_particles;
  float step;
  const float* weight;
  float drag_factor, gx, gy, gz;
  ConstRows u;
  Rows x, v;
  int slice_begin, slice_end;
};

WEFT_ALWAYS_INLINE void mesh_sweep_body(const MeshFilteredArguments& a) {
  const float *ux = a.u.x, *uy = a.u.y, *uz = a.u.z;
  const float step = a.step, step_sq = a.step * a.step;
  for (int slice = a.slice_begin; slice < a.slice_end; ++slice) {
    const int first = slice * kLanes;
    alignas(64) float sx[kLanes] = {}, sy[kLanes] = {}, sz[kLanes] = {};
    for (int row = a.table.slice_begin[slice]; row < a.table.slice_begin[slice + 1]; ++row) {
      const int* neighbour = a.table.neighbour.data() + row * kLanes;
      const float* stiffness = a.stiffness + row * kLanes;
      WEFT_IVDEP
      for (int lane = 0; lane < kLanes; ++lane) {
        const int j = neighbour[lane];
        const float k = stiffness[lane];
        sx[lane] += k * ux[j];
        sy[lane] += k * uy[j];
        sz[lane] += k * uz[j];
      }
    }
    const int count = std::min(kLanes, a.num_particles - first);
    WEFT_IVDEP
    for (int lane = 0; lane < count; ++lane) {
      const int i = first + lane;
      const float c = step_sq * a.weight[i];
      a.v.x[i] = a.drag_factor * a.v.x[i] + a.gx + (ux[i] + c * sx[lane]);
      a.v.y[i] = a.drag_factor * a.v.y[i] + a.gy + (uy[i] + c * sy[lane]);
      a.v.z[i] = a.drag_factor * a.v.z[i] + a.gz + (uz[i] + c * sz[lane]);
      a.x.x[i] += step * a.v.x[i];
      a.x.y[i] += step * a.v.y[i];
      a.x.z[i] += step * a.v.z[i];
    }
  }
}

WEFT_MULTIVERSION(mesh_sweep, (const MeshFilteredArguments& a), (a))

}  // namespace

void mesh_increments(const ClothModel& model, const Forcing& forcing, ConstRows x, ConstRows v,
                     const float* mass, const float* weight, Rows u, int slice_begin, int slice_end) {
  mesh_slices({model.table(), model.entry_stiffness.data(), model.num_particles(), forcing, x, v, mass,
               weight, u, slice_begin, slice_end});
}

void mesh_filtered(const ClothModel& model, float step, const float* weight, const Outside& outside,
                   ConstRows u, Rows x, Rows v, int slice_begin, int slice_end) {
  const Eigen::Vector3f g = outside.velocity_gain.cast<float>();
  mesh_sweep({model.table(), model.entry_stiffness.data(), model.num_particles(), step, weight,
              outside.drag_factor, g.x(), g.y(), g.z(), u, x, v, slice_begin, slice_end});
}

}  // namespace weft::engine::kernels
