#include "weft/forces/increments.h"

#include "weft/core/simd.h"
#include "weft/forces/increments_kernels.h"

namespace weft::engine {
namespace {

/// Particles per chunk of work: enough to outweigh the cost of scheduling it.
constexpr int kGrain = 4096;

/// Zeros to the left and right of a row of an IncrementField; stencils reach two to each side.
constexpr int kRowPadding = 16;
constexpr int kRowsAround = 2;

int rows_per_chunk(int row_length) { return std::max(1, kGrain / row_length); }

kernels::GridStencil make_stencil(const ClothModel& model) {
  const Grid& grid = *model.topology->grid;
  const double dx = grid.spacing_x(), dz = grid.spacing_z();
  const ClothMaterial& m = model.material;
  const auto family = [](double k, double length) {
    return kernels::Family{static_cast<float>(k), static_cast<float>(length)};
  };
  return {.num_columns = grid.num_columns(),
          .num_rows = grid.num_rows(),
          .across = family(m.structural, dx),
          .down = family(m.structural, dz),
          .diagonal = family(m.shear, std::sqrt(dx * dx + dz * dz)),
          .bend_across = family(m.bend, 2 * dx),
          .bend_down = family(m.bend, 2 * dz)};
}

kernels::Forcing make_forcing(const IncrementSettings& s) {
  const Eigen::Vector3f a = (s.acceleration + s.wind_rate * s.wind_velocity).cast<float>();
  return {.step = s.step,
          .damping_plain = s.projected ? 0.0f : s.damping,
          .damping_projected = s.projected ? s.damping : 0.0f,
          .stiffness_damping = s.stiffness_damping,
          .wind_rate = s.wind_rate,
          .ax = a.x(),
          .ay = a.y(),
          .az = a.z()};
}

}  // namespace

void IncrementField::fit(const ClothModel& model) {
  const bool is_grid = model.has_equal_springs();
  const int row_length = is_grid ? model.topology->grid->num_columns() : model.num_particles();
  const int num_rows = is_grid ? model.topology->grid->num_rows() : 1;
  if (row_length == row_length_ && num_rows == num_rows_) return;
  row_length_ = row_length;
  num_rows_ = num_rows;
  stride_ = (row_length + kRowPadding - 1) / kRowPadding * kRowPadding + kRowPadding;
  first_ = kRowsAround * stride_ + kRowPadding;
  values = Vec3Array(static_cast<std::size_t>(num_rows + 2 * kRowsAround) * stride_);
}

void compute_increments(const ClothModel& model, const ClothState& state, const IncrementSettings& settings,
                        const std::vector<float>& mass, const std::vector<float>& weight, JobSystem& jobs,
                        IncrementField& u) {
  u.fit(model);
  const kernels::Forcing forcing = make_forcing(settings);
  const kernels::ConstRows x = kernels::rows(state.x), v = kernels::rows(state.v);
  const kernels::Rows out = kernels::rows(u.values);
  if (model.has_equal_springs()) {
    const kernels::GridStencil stencil = make_stencil(model);
    parallel_for(jobs, u.num_rows(), rows_per_chunk(u.row_length()), [&](int begin, int end) {
      kernels::grid_increments(stencil, model.topology->spring_model, forcing, x, v, mass.data(),
                               weight.data(), {u.index(0), u.stride()}, out, begin, end);
    });
  } else {
    const int first = u.index(0);
    parallel_for(jobs, model.table().num_slices(), kGrain / NeighbourTable::kLanes, [&](int begin, int end) {
      kernels::mesh_increments(model, forcing, x, v, mass.data(), weight.data(),
                               {out.x + first, out.y + first, out.z + first}, begin, end);
    });
  }
}

void apply_increments(const IncrementField& u, float step, const Vec3& g_step, JobSystem& jobs,
                      ClothState& state) {
  const Eigen::Vector3f g = g_step.cast<float>();
  parallel_for(jobs, u.num_rows(), rows_per_chunk(u.row_length()), [&](int begin, int end) {
    for (int row = begin; row < end; ++row) {
      const int in = u.index(row * u.row_length()), out = row * u.row_length();
      const auto apply = [&](const float* increment, float g_c, float* x, float* v) {
        WEFT_IVDEP
        for (int i = 0; i < u.row_length(); ++i) {
          v[i] += increment[i] + g_c;
          x[i] += step * v[i];
        }
      };
      apply(u.values.x() + in, g.x(), state.x.x() + out, state.v.x() + out);
      apply(u.values.y() + in, g.y(), state.x.y() + out, state.v.y() + out);
      apply(u.values.z() + in, g.z(), state.x.z() + out, state.v.z() + out);
    }
  });
}

void apply_filtered_increments(const ClothModel& model, const IncrementField& u, float step,
                               const std::vector<float>& weight, const Outside& outside, JobSystem& jobs,
                               ClothState& state) {
  const kernels::ConstRows in = kernels::rows(u.values);
  const kernels::Rows x = kernels::rows(state.x), v = kernels::rows(state.v);
  if (model.has_equal_springs()) {
    const kernels::GridStencil stencil = make_stencil(model);
    parallel_for(jobs, u.num_rows(), rows_per_chunk(u.row_length()), [&](int begin, int end) {
      kernels::grid_filtered(stencil, model.topology->spring_model, step, weight.data(), outside,
                             {u.index(0), u.stride()}, in, x, v, begin, end);
    });
  } else {
    const int first = u.index(0);
    parallel_for(jobs, model.table().num_slices(), kGrain / NeighbourTable::kLanes, [&](int begin, int end) {
      kernels::mesh_filtered(model, step, weight.data(), outside, {in.x + first, in.y + first, in.z + first},
                             x, v, begin, end);
    });
  }
}

std::vector<float> to_padded_floats(const std::vector<double>& values) {
  std::vector<float> floats(values.begin(), values.end());
  floats.resize(values.size() + Vec3Array::kPadding, 0.0f);
  return floats;
}

}  // namespace weft::engine
