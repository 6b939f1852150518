#include "weft/solvers/grid_multigrid.h"

#include <algorithm>
#include <utility>

#include "weft/solvers/dense_inverse.h"
#include "weft/solvers/grid_multigrid_kernels.h"

namespace weft::engine {
namespace {

constexpr int kGrain = 4096;   // particles per chunk of work
constexpr int kCoarsest = 25;  // grids up to this many particles are solved directly

/// body(row_begin, row_end) over chunks of rows.
template <class Body>
void for_rows(JobSystem& jobs, const PaddedRows& rows, const Body& body) {
  parallel_for(jobs, rows.num_rows, std::max(1, kGrain / rows.row_length), body);
}

}  // namespace

GridMatrix::GridMatrix(const PaddedRows& r) : rows(r) {
  for (auto* values : {&right, &down, &down_right, &down_left, &excess, &diagonal})
    values->assign(rows.size() + kPackLanes, 0.0f);
}

GridLevel::GridLevel(const PaddedRows& r) : GridMatrix(r), inverse(right) {
  for (Vec3Array* values : {&right_side, &value, &smoothed}) values->resize(rows.size());
}

void GridMultigrid::resize(const PaddedRows& rows) {
  if (!levels_.empty() && levels_.front().rows == rows) return;
  levels_.clear();
  levels_.emplace_back(rows);
  levels_.front().right_side = levels_.front().smoothed = Vec3Array();  // apply() uses those of its caller
  narrowed_.clear();
  while (levels_.back().rows.num_particles() > kCoarsest) {
    const PaddedRows fine = levels_.back().rows;
    narrowed_.emplace_back(PaddedRows{coarse_length(fine.row_length), fine.num_rows});
    levels_.emplace_back(PaddedRows{coarse_length(fine.row_length), coarse_length(fine.num_rows)});
  }
  dots_.assign(rows.num_rows, 0.0);
}

void GridMultigrid::build(JobSystem& jobs) {
  using namespace grid_kernels;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    GridLevel& level = levels_[l];
    for_rows(jobs, level.rows, [&](int begin, int end) { finish_rows(level, begin, end); });
    if (l + 1 == levels_.size()) break;
    GridLevel& coarse = levels_[l + 1];
    GridMatrix& narrow = narrowed_[l];
    for_rows(jobs, level.rows, [&](int begin, int end) { narrow_rows(level, narrow, begin, end); });
    for_rows(jobs, coarse.rows, [&](int begin, int end) { merge_rows(narrow, coarse, begin, end); });
  }
  invert_coarsest();
}

void GridMultigrid::invert_coarsest() {
  const GridLevel& level = levels_.back();
  const PaddedRows& rows = level.rows;
  const int n = rows.num_particles();
  coarsest_inverse_.assign(static_cast<std::size_t>(n) * n, 0.0);
  const auto couple = [&](int a, int b, double c) {
    coarsest_inverse_[a * n + a] += c;
    coarsest_inverse_[b * n + b] += c;
    coarsest_inverse_[a * n + b] -= c;
    coarsest_inverse_[b * n + a] -= c;
  };
  for (int j = 0; j < rows.num_rows; ++j) {
    for (int i = 0; i < rows.row_length; ++i) {
      const int a = j * rows.row_length + i, at = rows.index(a);
      const bool has_right = i + 1 < rows.row_length, has_down = j + 1 < rows.num_rows;
      coarsest_inverse_[a * n + a] += level.excess[at];
      if (has_right) couple(a, a + 1, level.right[at]);
      if (has_down) couple(a, a + rows.row_length, level.down[at]);
      if (has_right && has_down) couple(a, a + rows.row_length + 1, level.down_right[at]);
      if (i > 0 && has_down) couple(a, a + rows.row_length - 1, level.down_left[at]);
    }
  }
  invert_in_place(coarsest_inverse_, n);
}

void GridMultigrid::solve_coarsest(const Vec3Array& b, Vec3Array& out) const {
  const PaddedRows& rows = levels_.back().rows;
  const int n = rows.num_particles();
  for (int i = 0; i < n; ++i) {
    Vec3 sum = Vec3::Zero();
    for (int j = 0; j < n; ++j) sum += coarsest_inverse_[i * n + j] * b.get(rows.index(j));
    out.set(rows.index(i), sum);
  }
}

double GridMultigrid::apply(const Vec3Array& r, JobSystem& jobs, Vec3Array& z) {
  if (levels_.size() == 1) return apply_coarsest(r, z);
  cycle(0, r, z, jobs, dots_.data());
  double sum = 0;
  for (const double d : dots_) sum += d;
  return sum;
}

double GridMultigrid::apply_coarsest(const Vec3Array& r, Vec3Array& z) const {
  const PaddedRows& rows = levels_.back().rows;
  solve_coarsest(r, z);
  double sum = 0;
  for (int i = 0; i < rows.num_particles(); ++i) sum += r.get(rows.index(i)).dot(z.get(rows.index(i)));
  return sum;
}

void GridMultigrid::cycle(std::size_t l, const Vec3Array& right_side, Vec3Array& out, JobSystem& jobs,
                          double* dots) {
  using namespace grid_kernels;
  if (l + 1 == levels_.size()) return solve_coarsest(right_side, out);
  GridLevel &fine = levels_[l], &coarse = levels_[l + 1];
  const ConstComponent3 b = components(right_side);
  const Component3 x = components(fine.value);
  const ConstComponent3 now{x.x, x.y, x.z};
  for_rows(jobs, fine.rows, [&](int begin, int end) { smooth_from_zero(fine, b, x, begin, end); });
  const Component3 coarse_side = components(coarse.right_side);
  for_rows(jobs, coarse.rows,
           [&](int begin, int end) { restrict_residual(fine, b, now, coarse, coarse_side, begin, end); });
  cycle(l + 1, coarse.right_side, coarse.smoothed, jobs, nullptr);
  const ConstComponent3 correction = components(std::as_const(coarse.smoothed));
  for_rows(jobs, fine.rows, [&](int begin, int end) { prolong(coarse, correction, fine, x, begin, end); });
  const Component3 result = components(out);
  for_rows(jobs, fine.rows, [&](int begin, int end) { smooth(fine, b, now, result, begin, end, dots); });
}

}  // namespace weft::engine
