/// Springs on a grid as stencils.
///
/// Each spring is evaluated once, by the upper left of its two particles (its owner), one row of owners at a
/// time, into small row buffers. A particle then gathers: its own springs with +, those that end at it with
/// −.
///
///     o--H--o          owner of: H across, V down, D main diagonal, BH and BV to the particle two away
///     | \ D |          E, the other diagonal of the cell, joins the particle to the right of the owner
///     V  \  |          with the one below the owner
///     |   \ |
///     o-----o
///
/// Rows are computed in full vector registers, beyond the row's end; that padding is set to zero before it is
/// read.

#include <algorithm>

#include "weft/forces/increments_kernels.h"

namespace weft::engine::kernels {
namespace {

constexpr int kLanes = 16;

int round_up(int n) { return (n + kLanes - 1) / kLanes * kLanes; }

/// The forces of one family of springs along one row; index -kLanes … round_up(columns) - 1, zero below 0.
struct ForceRow {
  float *x, *y, *z;

  void clear(int from, int to) const {
    for (float* component : {x, y, z}) std::fill(component + from, component + to, 0.0f);
  }
};

/// Row buffers of one thread, kept between calls to avoid allocations in a step.
class ForceRows {
 public:
  ForceRow down(int j) const { return row(0 + slot(j, 2)); }
  ForceRow main_diagonal(int j) const { return row(2 + slot(j, 2)); }
  ForceRow anti_diagonal(int j) const { return row(4 + slot(j, 2)); }
  ForceRow bend_down(int j) const { return row(6 + slot(j, 3)); }
  ForceRow across() const { return row(9); }
  ForceRow bend_across() const { return row(10); }

  void fit(int num_columns) {
    pitch_ = round_up(num_columns) + kLanes;
    values_.assign(static_cast<std::size_t>(kNumRows) * 3 * pitch_, 0.0f);
  }

 private:
  static constexpr int kNumRows = 11;

  static int slot(int j, int count) { return (j + 6) % count; }

  ForceRow row(int r) const {
    float* begin = const_cast<float*>(values_.data()) + static_cast<std::size_t>(3 * r) * pitch_ + kLanes;
    return {begin, begin + pitch_, begin + 2 * pitch_};
  }

  int pitch_ = 0;
  std::vector<float> values_;
};

/// Forces on p of `count` springs p–q, with p and q advancing together.
template <bool kProjected>
WEFT_ALWAYS_INLINE void spring_row(ConstRows x, ConstRows v, int p, int q, int count, Family family,
                                   const Forcing& forcing, ForceRow out) {
  const float k = family.stiffness, l0 = family.rest_length;
  const float b = forcing.damping_projected;
  const float c = forcing.damping_plain + forcing.stiffness_damping * k;
  const float *px = x.x + p, *py = x.y + p, *pz = x.z + p, *qx = x.x + q, *qy = x.y + q, *qz = x.z + q;
  const float *pu = v.x + p, *pv = v.y + p, *pw = v.z + p, *qu = v.x + q, *qv = v.y + q, *qw = v.z + q;
  float *fx = out.x, *fy = out.y, *fz = out.z;
  WEFT_IVDEP
  for (int i = 0; i < count; ++i) {
    const float dx = qx[i] - px[i], dy = qy[i] - py[i], dz = qz[i] - pz[i];
    const float wx = qu[i] - pu[i], wy = qv[i] - pv[i], wz = qw[i] - pw[i];
    const float s = pull<kProjected>(k, l0, b, dx, dy, dz, wx, wy, wz);
    fx[i] = s * dx + c * wx;
    fy[i] = s * dy + c * wy;
    fz[i] = s * dz + c * wz;
  }
}

/// One diagonal per cell, of alternating direction: main where i + j is even. Each direction has its own row.
template <bool kProjected>
WEFT_ALWAYS_INLINE void alternating_row(ConstRows x, ConstRows v, int p, int q, int j, int count,
                                        Family family, const Forcing& forcing, ForceRow main_row,
                                        ForceRow anti_row) {
  const float k = family.stiffness, l0 = family.rest_length;
  const float b = forcing.damping_projected;
  const float c = forcing.damping_plain + forcing.stiffness_damping * k;
  const float *px = x.x + p, *py = x.y + p, *pz = x.z + p, *qx = x.x + q, *qy = x.y + q, *qz = x.z + q;
  const float *pu = v.x + p, *pv = v.y + p, *pw = v.z + p, *qu = v.x + q, *qv = v.y + q, *qw = v.z + q;
  float *mx = main_row.x, *my = main_row.y, *mz = main_row.z;
  float *nx = anti_row.x, *ny = anti_row.y, *nz = anti_row.z;
  WEFT_IVDEP
  for (int i = 0; i < count; ++i) {
    const bool is_main = ((i + j) & 1) == 0;
    const float mdx = qx[i + 1] - px[i], mdy = qy[i + 1] - py[i], mdz = qz[i + 1] - pz[i];
    const float ndx = qx[i] - px[i + 1], ndy = qy[i] - py[i + 1], ndz = qz[i] - pz[i + 1];
    const float mwx = qu[i + 1] - pu[i], mwy = qv[i + 1] - pv[i], mwz = qw[i + 1] - pw[i];
    const float nwx = qu[i] - pu[i + 1], nwy = qv[i] - pv[i + 1], nwz = qw[i] - pw[i + 1];
    const float dx = is_main ? mdx : ndx, dy = is_main ? mdy : ndy, dz = is_main ? mdz : ndz;
    const float wx = is_main ? mwx : nwx, wy = is_main ? mwy : nwy, wz = is_main ? mwz : nwz;
    const float s = pull<kProjected>(k, l0, b, dx, dy, dz, wx, wy, wz);
    const float fx = s * dx + c * wx, fy = s * dy + c * wy, fz = s * dz + c * wz;
    mx[i] = is_main ? fx : 0.0f;
    my[i] = is_main ? fy : 0.0f;
    mz[i] = is_main ? fz : 0.0f;
    nx[i] = is_main ? 0.0f : fx;
    ny[i] = is_main ? 0.0f : fy;
    nz[i] = is_main ? 0.0f : fz;
  }
}

template <bool kAnti>
WEFT_ALWAYS_INLINE void gather_component(int count, const float* across, const float* down,
                                         const float* down_above, const float* main, const float* main_above,
                                         const float* anti, const float* anti_above, const float* bend_across,
                                         const float* bend_down, const float* bend_above, const float* v,
                                         const float* mass, const float* weight, float acceleration,
                                         float wind_rate, float step, float* u) {
  WEFT_IVDEP
  for (int i = 0; i < count; ++i) {
    float f = (across[i] - across[i - 1]) + (down[i] - down_above[i]);
    f += main[i] - main_above[i - 1];
    if (kAnti) f += anti[i - 1] - anti_above[i];
    f += (bend_across[i] - bend_across[i - 2]) + (bend_down[i] - bend_above[i]);
    f += mass[i] * (acceleration - wind_rate * v[i]);
    u[i] = step * weight[i] * f;
  }
}

template <bool kProjected, SpringModel kModel>
WEFT_ALWAYS_INLINE void grid_rows_impl(const GridStencil& stencil, const Forcing& forcing, ConstRows x,
                                       ConstRows v, const float* mass, const float* weight,
                                       FieldLayout layout, Rows u, const ForceRows& buffers, int row_begin,
                                       int row_end) {
  constexpr bool kAnti = kModel != SpringModel::simplified;
  const int nx = stencil.num_columns, nz = stencil.num_rows, count = round_up(nx);

  // Springs from row j to the rows below.
  const auto compute_down = [&](int j) WEFT_INLINE_LAMBDA {
    const int p = j * nx, q = p + nx;
    const ForceRow down = buffers.down(j), main = buffers.main_diagonal(j), anti = buffers.anti_diagonal(j);
    if (j < 0 || j + 1 >= nz) {
      for (const ForceRow& row : {down, main, anti}) row.clear(0, count);
    } else {
      spring_row<kProjected>(x, v, p, q, count, stencil.down, forcing, down);
      if (kModel == SpringModel::alternating) {
        alternating_row<kProjected>(x, v, p, q, j, count, stencil.diagonal, forcing, main, anti);
      } else {
        spring_row<kProjected>(x, v, p, q + 1, count, stencil.diagonal, forcing, main);
        if (kAnti) spring_row<kProjected>(x, v, p + 1, q, count, stencil.diagonal, forcing, anti);
      }
      main.clear(nx - 1, count);
      if (kAnti) anti.clear(nx - 1, count);
    }
    const ForceRow bend = buffers.bend_down(j);
    if (j < 0 || j + 2 >= nz) {
      bend.clear(0, count);
    } else {
      spring_row<kProjected>(x, v, p, p + 2 * nx, count, stencil.bend_down, forcing, bend);
    }
  };

  compute_down(row_begin - 2);
  compute_down(row_begin - 1);
  for (int j = row_begin; j < row_end; ++j) {
    // Rows across first: their shifted loads stall while their stores are still in flight.
    const int p = j * nx;
    const ForceRow across = buffers.across(), bend_across = buffers.bend_across();
    spring_row<kProjected>(x, v, p, p + 1, count, stencil.across, forcing, across);
    across.clear(nx - 1, count);
    spring_row<kProjected>(x, v, p, p + 2, count, stencil.bend_across, forcing, bend_across);
    bend_across.clear(std::max(nx - 2, 0), count);
    compute_down(j);

    const ForceRow down = buffers.down(j), down_above = buffers.down(j - 1);
    const ForceRow main = buffers.main_diagonal(j), main_above = buffers.main_diagonal(j - 1);
    const ForceRow anti = buffers.anti_diagonal(j), anti_above = buffers.anti_diagonal(j - 1);
    const ForceRow bend_down = buffers.bend_down(j), bend_above = buffers.bend_down(j - 2);
    const int out = layout.first + j * layout.stride;
    const auto gather = [&](float* ForceRow::*c, const float* velocity, float acceleration,
                            float* increment) WEFT_INLINE_LAMBDA {
      gather_component<kAnti>(count, across.*c, down.*c, down_above.*c, main.*c, main_above.*c, anti.*c,
                              anti_above.*c, bend_across.*c, bend_down.*c, bend_above.*c, velocity + p,
                              mass + p, weight + p, acceleration, forcing.wind_rate, forcing.step,
                              increment + out);
      std::fill(increment + out + nx, increment + out + count, 0.0f);
    };
    gather(&ForceRow::x, v.x, forcing.ax, u.x);
    gather(&ForceRow::y, v.y, forcing.ay, u.y);
    gather(&ForceRow::z, v.z, forcing.az, u.z);
  }
}

struct GridRowsArguments {
  const GridStencil& stencil;
  const Forcing& forcing;
  ConstRows x, v;
  const float *mass, *weight;
  FieldLayout layout;
  Rows u;
  const ForceRows& buffers;
  int row_begin, row_end;
};

template <SpringModel kModel>
WEFT_ALWAYS_INLINE void grid_rows_model(const GridRowsArguments& a) {
  if (a.forcing.damping_projected != 0) {
    grid_rows_impl<true, kModel>(a.stencil, a.forcing, a.x, a.v, a.mass, a.weight, a.layout, a.u, a.buffers,
                                 a.row_begin, a.row_end);
  } else {
    grid_rows_impl<false, kModel>(a.stencil, a.forcing, a.x, a.v, a.mass, a.weight, a.layout, a.u, a.buffers,
                                  a.row_begin, a.row_end);
  }
}

WEFT_ALWAYS_INLINE void grid_rows_body(const GridRowsArguments& a, SpringModel model) {
  switch (model) {
    case SpringModel::basic:
      return grid_rows_model<SpringModel::basic>(a);
    case SpringModel::simplified:
      return grid_rows_model<SpringModel::simplified>(a);
    case SpringModel::alternating:
      return grid_rows_model<SpringModel::alternating>(a);
  }
}

WEFT_MULTIVERSION(grid_rows, (const GridRowsArguments& a, SpringModel model), (a, model))

/// One component of one row of the second sweep. `even` is the parity of i + j at which a particle of the
/// alternating model has all four diagonals; at the other parity it has none.
template <SpringModel kModel>
WEFT_ALWAYS_INLINE void filtered_component(int count, int stride, int j, float structural, float shear,
                                           float bend, float step, const float* weight, float drag_factor,
                                           float velocity_gain, const float* u, float* x, float* v) {
  const float *up = u - stride, *down = u + stride, *up2 = u - 2 * stride, *down2 = u + 2 * stride;
  const float step_sq = step * step;
  WEFT_IVDEP
  for (int i = 0; i < count; ++i) {
    float s = structural * ((u[i - 1] + u[i + 1]) + (up[i] + down[i]));
    const float main = up[i - 1] + down[i + 1];
    if (kModel == SpringModel::simplified) {
      s += shear * main;
    } else {
      const float all = main + (up[i + 1] + down[i - 1]);
      const bool here = kModel == SpringModel::basic || ((i + j) & 1) == 0;
      s += here ? shear * all : 0.0f;
    }
    s += bend * ((u[i - 2] + u[i + 2]) + (up2[i] + down2[i]));
    v[i] = drag_factor * v[i] + velocity_gain + (u[i] + step_sq * weight[i] * s);
    x[i] += step * v[i];
  }
}

struct GridFilteredArguments {
  const GridStencil& stencil;
  float step;
  const float* weight;
  float drag_factor, gx, gy, gz;
  FieldLayout layout;
  ConstRows u;
  Rows x, v;
  int row_begin, row_end;
};

template <SpringModel kModel>
WEFT_ALWAYS_INLINE void grid_filtered_model(const GridFilteredArguments& a) {
  const int nx = a.stencil.num_columns;
  const float structural = a.stencil.across.stiffness, shear = a.stencil.diagonal.stiffness;
  const float bend = a.stencil.bend_across.stiffness;
  for (int j = a.row_begin; j < a.row_end; ++j) {
    const int p = j * nx, in = a.layout.first + j * a.layout.stride;
    const auto sweep = [&](const float* u, float* x, float* v, float g) WEFT_INLINE_LAMBDA {
      filtered_component<kModel>(nx, a.layout.stride, j, structural, shear, bend, a.step, a.weight + p,
                                 a.drag_factor, g, u + in, x + p, v + p);
    };
    sweep(a.u.x, a.x.x, a.v.x, a.gx);
    sweep(a.u.y, a.x.y, a.v.y, a.gy);
    sweep(a.u.z, a.x.z, a.v.z, a.gz);
  }
}

WEFT_ALWAYS_INLINE void grid_sweep_body(const GridFilteredArguments& a, SpringModel model) {
  switch (model) {
    case SpringModel::basic:
      return grid_filtered_model<SpringModel::basic>(a);
    case SpringModel::simplified:
      return grid_filtered_model<SpringModel::simplified>(a);
    case SpringModel::alternating:
      return grid_filtered_model<SpringModel::alternating>(a);
  }
}

WEFT_MULTIVERSION(grid_sweep, (const GridFilteredArguments& a, SpringModel model), (a, model))

}  // namespace

void grid_increments(const GridStencil& stencil, SpringModel model, const Forcing& forcing, ConstRows x,
                     ConstRows v, const float* mass, const float* weight, FieldLayout layout, Rows u,
                     int row_begin, int row_end) {
  static thread_local ForceRows buffers;
  buffers.fit(stencil.num_columns);
  grid_rows({stencil, forcing, x, v, mass, weight, layout, u, buffers, row_begin, row_end}, model);
}

void grid_filtered(const GridStencil& stencil, SpringModel model, float step, const float* weight,
                   const Outside& outside, FieldLayout layout, ConstRows u, Rows x, Rows v, int row_begin,
                   int row_end) {
  const Eigen::Vector3f g = outside.velocity_gain.cast<float>();
  grid_sweep(
      {stencil, step, weight, outside.drag_factor, g.x(), g.y(), g.z(), layout, u, x, v, row_begin, row_end},
      model);
}

}  // namespace weft::engine::kernels
