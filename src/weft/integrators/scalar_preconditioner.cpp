#include "weft/integrators/scalar_preconditioner.h"

#include <algorithm>

namespace weft {

void ScalarPreconditioner::build(const ClothModel& model, const PaddedRows& rows, double damping,
                                 const std::vector<float>& diagonal, const std::vector<int>& pinned,
                                 JobSystem& jobs) {
  grid_.resize(rows);
  fill_grid(model, damping);
  std::copy(diagonal.begin(), diagonal.end(), grid_.finest().excess.begin());
  pin_grid(pinned);
  grid_.build(jobs);
}

void ScalarPreconditioner::fill_grid(const ClothModel& model, double damping) {
  GridLevel& level = grid_.finest();
  const ClothMaterial& m = model.material;
  const SpringModel spring_model = model.topology->spring_model;
  const auto structural = static_cast<float>(m.structural + 4 * m.bend + 5 * damping);
  const auto shear = static_cast<float>(m.shear + damping);
  const int columns = level.rows.row_length, num_rows = level.rows.num_rows;
  level.has_down_left = spring_model != SpringModel::simplified;
  const bool alternates = spring_model == SpringModel::alternating;
  for (int j = 0; j < num_rows; ++j) {
    const int first = level.rows.row(j);
    std::fill_n(level.right.begin() + first, columns - 1, structural);
    if (j + 1 == num_rows) break;
    std::fill_n(level.down.begin() + first, columns, structural);
    for (int i = 0; i < columns; ++i) {
      const float here = alternates && (i + j) % 2 == 1 ? 0.0f : shear;
      level.down_right[first + i] = i + 1 < columns ? here : 0.0f;
      if (level.has_down_left) level.down_left[first + i] = i > 0 ? here : 0.0f;
    }
  }
}

void ScalarPreconditioner::pin_grid(const std::vector<int>& pinned) {
  GridLevel& level = grid_.finest();
  const int stride = level.rows.stride();
  for (const int particle : pinned) {
    const int p = level.rows.index(particle);
    const auto cut = [&](float& coupling, int neighbour) {
      level.excess[neighbour] += coupling;
      coupling = 0;
    };
    cut(level.right[p], p + 1);
    cut(level.right[p - 1], p - 1);
    cut(level.down[p], p + stride);
    cut(level.down[p - stride], p - stride);
    cut(level.down_right[p], p + stride + 1);
    cut(level.down_right[p - stride - 1], p - stride - 1);
    cut(level.down_left[p], p + stride - 1);
    cut(level.down_left[p - stride + 1], p - stride + 1);
  }
  for (const int particle : pinned) level.excess[level.rows.index(particle)] = 0;
}

double ScalarPreconditioner::apply(const Vec3Array& r, JobSystem& jobs, Vec3Array& z) {
  return grid_.apply(r, jobs, z);
}

}  // namespace weft
