#include "weft/forces/element_potential.h"

#include <algorithm>
#include <utility>

#include "weft/core/error.h"
#include "weft/forces/element_kernels.h"

namespace weft {
namespace {

using kernels::GridElements;
using kernels::MeshElements;

constexpr int kGrain = 4096;  // particles per chunk of work

int rows_per_chunk(const PaddedRows& rows) { return std::max(1, kGrain / rows.row_length); }

constexpr int kSlicesPerChunk = kGrain / kPackLanes;

WEFT_ALWAYS_INLINE void add_scaled_body(const float* x, float share, const float* z, float* sum, int begin,
                                        int end) {
  WEFT_IVDEP
  for (int i = begin; i < end; ++i) sum[i] = x[i] + share * z[i];
}

WEFT_MULTIVERSION(add_scaled, (const float* x, float share, const float* z, float* sum, int begin, int end),
                  (x, share, z, sum, begin, end))

}  // namespace

void ElementPotential::fit(const ClothModel& model, const PaddedRows& rows, double damping_rate) {
  damping_ = model.elements ? static_cast<float>(model.elements->damping * damping_rate) : 0.0f;
  if (model.elements == elements_ && model.topology == topology_) return;
  elements_ = model.elements;
  topology_ = model.topology;
  if (!elements_) return;
  if (!elements_->hinges.empty())
    throw InputError("newton bends by curvature stencils; build the elements with BendingModel::stencils");
  rows_ = rows;
  is_grid_ = topology_->grid.has_value();
  if (is_grid_) {
    fit_grid(model);
  } else {
    fit_mesh(model);
  }
  bent_ = Vec3Array(rows_.size());
}

void ElementPotential::fit_grid(const ClothModel& model) {
  if (!elements_->grid_warp)
    throw InputError(
        "on a grid warp must be along one of its axes (build_grid_elements); for others use "
        "build_mesh_topology");
  const std::size_t plane = rows_.size();
  const BendingMatrix matrix = build_bending_matrix(elements_->bending, model.num_particles());
  bending_.assign(GridElements::kFamilies * plane + kPackLanes, 0.0f);
  const int columns = rows_.row_length;
  for (int i = 0; i < model.num_particles(); ++i) {
    for (int k = matrix.begin[i]; k < matrix.begin[i + 1]; ++k) {
      const int j = matrix.column[k], down = j / columns - i / columns, right = j % columns - i % columns;
      for (int f = 0; f < GridElements::kFamilies; ++f) {
        if (down == GridElements::kRow[f] && right == GridElements::kColumn[f])
          bending_[f * plane + rows_.index(i)] = static_cast<float>(-matrix.value[k]);
      }
    }
  }
  past_.assign(6 * plane + kPackLanes, 0.0f);
  stress_.assign(6 * plane + kPackLanes, 0.0f);
  slope_.assign(4 * plane + kPackLanes, 0.0f);
  hessian_.clear();
  hessian_.assign(grid_view().hessian_size(), 0.0f);
  parts_.assign(rows_.num_rows, 0.0);
}

void ElementPotential::fit_mesh(const ClothModel& model) {
  tables_ = build_element_tables(*elements_, model.num_particles());
  const std::size_t triangles = static_cast<std::size_t>(tables_.num_triangle_slices()) * kPackLanes;
  past_.assign(3 * triangles, 0.0f);
  stress_.assign(MeshElements::kFrameSize * triangles, 0.0f);
  hessian_.assign(static_cast<std::size_t>(tables_.num_entry_rows()) * kernels::kBlockSize * kPackLanes,
                  0.0f);
  parts_.assign(tables_.num_triangle_slices() + tables_.num_slices(), 0.0);
}

GridElements ElementPotential::grid_view() {
  const Grid& grid = *topology_->grid;
  const float stiffening = 1 + damping_;
  const Mat3& c = elements_->stiffness;
  const bool is_along_x = elements_->grid_warp == GridWarp::first_axis;
  const auto along_x = static_cast<float>(is_along_x ? c(0, 0) : c(1, 1));
  const auto along_z = static_cast<float>(is_along_x ? c(1, 1) : c(0, 0));
  return {.rows = rows_,
          .alternates = diagonals_of(topology_->spring_model) == GridDiagonals::alternating,
          .dx = static_cast<float>(grid.spacing_x()),
          .dz = static_cast<float>(grid.spacing_z()),
          .membrane = {stiffening * along_x, stiffening * along_z, stiffening * static_cast<float>(c(0, 1)),
                       stiffening * static_cast<float>(c(2, 2))},
          .damping = damping_,
          .bending = bending_.data(),
          .past = past_.data(),
          .stress = stress_.data(),
          .slope = slope_.data(),
          .hessian = hessian_.data()};
}

MeshElements ElementPotential::mesh_view() {
  const float stiffening = 1 + damping_;
  const Mat3& c = elements_->stiffness;
  return {.first = rows_.row(0),
          .membrane = {stiffening * static_cast<float>(c(0, 0)), stiffening * static_cast<float>(c(1, 1)),
                       stiffening * static_cast<float>(c(0, 1)), stiffening * static_cast<float>(c(2, 2))},
          .damping = damping_,
          .corner = tables_.corner.data(),
          .shape = tables_.shape.data(),
          .past = past_.data(),
          .frame = stress_.data(),
          .slice_begin = tables_.slice_begin.data(),
          .neighbour = tables_.neighbour.data(),
          .triangle = tables_.triangle.data(),
          .entry = tables_.entry.data(),
          .far_begin = tables_.far_begin.data(),
          .far_neighbour = tables_.far_neighbour.data(),
          .far_bending = tables_.far_bending.data(),
          .hessian = hessian_.data()};
}

void ElementPotential::remember(const Vec3Array& start, const Vec3Array& before, double memory,
                                JobSystem& jobs) {
  if (!is_damped()) return;
  const double share = damping_ / (1 + damping_);
  std::fill(past_.begin(), past_.end(), 0.0f);
  add_past(start, share * (1 + memory), jobs);
  if (memory != 0) add_past(before, -share * memory, jobs);
}

void ElementPotential::add_past(const Vec3Array& x, double share, JobSystem& jobs) {
  const auto s = static_cast<float>(share);
  if (is_grid_) {
    GridElements g = grid_view();
    g.x = kernels::rows(x);
    return parallel_for(jobs, rows_.num_rows, rows_per_chunk(rows_),
                        [&](int begin, int end) { kernels::grid_past(g, s, begin, end); });
  }
  MeshElements m = mesh_view();
  m.x = kernels::rows(x);
  parallel_for(jobs, tables_.num_triangle_slices(), kSlicesPerChunk,
               [&](int begin, int end) { kernels::mesh_past(m, s, begin, end); });
}

double ElementPotential::sum_parts(int count) const {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += parts_[i];
  return sum;
}

double ElementPotential::energy(const Vec3Array& x, const Vec3Array& z, JobSystem& jobs) {
  double* parts = parts_.data();
  if (is_grid_) {
    GridElements g = grid_view();
    g.x = kernels::rows(x);
    g.damped = kernels::rows(z);
    parallel_for(jobs, rows_.num_rows, rows_per_chunk(rows_),
                 [&](int begin, int end) { kernels::grid_membranes(g, begin, end, parts); });
    return sum_parts(rows_.num_rows);
  }
  MeshElements m = mesh_view();
  m.x = kernels::rows(x);
  m.damped = kernels::rows(z);
  double* bending = parts + tables_.num_triangle_slices();
  parallel_for(jobs, tables_.num_triangle_slices(), kSlicesPerChunk,
               [&](int begin, int end) { kernels::mesh_membranes(m, begin, end, parts); });
  parallel_for(jobs, tables_.num_slices(), kSlicesPerChunk,
               [&](int begin, int end) { kernels::mesh_bending(m, begin, end, bending); });
  return sum_parts(static_cast<int>(parts_.size()));
}

double ElementPotential::linearise(const Vec3Array& x, const Vec3Array& z, JobSystem& jobs,
                                   Vec3Array& force) {
  const double value = energy(x, z, jobs);
  if (is_damped()) {
    const auto bend = [&](const float* from, const float* by, float* to) {
      parallel_for(jobs, static_cast<int>(rows_.size()), 4 * kGrain,
                   [&](int begin, int end) { add_scaled(from, damping_, by, to, begin, end); });
    };
    bend(x.x(), z.x(), bent_.x());
    bend(x.y(), z.y(), bent_.y());
    bend(x.z(), z.z(), bent_.z());
  }
  const Vec3Array& bent = is_damped() ? bent_ : x;
  if (is_grid_) {
    GridElements g = grid_view();
    g.x = kernels::rows(x);
    g.bent = kernels::rows(bent);
    g.force = kernels::rows(force);
    parallel_for(jobs, rows_.num_rows, rows_per_chunk(rows_),
                 [&](int begin, int end) { kernels::grid_blocks(g, begin, end); });
    parallel_for(jobs, rows_.num_rows, rows_per_chunk(rows_),
                 [&](int begin, int end) { kernels::grid_element_forces(g, begin, end); });
    return value;
  }
  MeshElements m = mesh_view();
  m.x = kernels::rows(x);
  m.bent = kernels::rows(bent);
  m.force = kernels::rows(force);
  parallel_for(jobs, tables_.num_slices(), kSlicesPerChunk,
               [&](int begin, int end) { kernels::mesh_blocks(m, begin, end); });
  return value;
}

double ElementPotential::multiply(const Vec3Array& p, JobSystem& jobs, Vec3Array& q) {
  const kernels::ConstRows in = kernels::rows(p);
  const kernels::Rows out = kernels::rows(q);
  double* parts = parts_.data();
  if (is_grid_) {
    const GridElements g = grid_view();
    parallel_for(jobs, rows_.num_rows, rows_per_chunk(rows_),
                 [&](int begin, int end) { kernels::grid_multiply_elements(g, in, out, begin, end, parts); });
    return sum_parts(rows_.num_rows);
  }
  const MeshElements m = mesh_view();
  parallel_for(jobs, tables_.num_slices(), kSlicesPerChunk,
               [&](int begin, int end) { kernels::mesh_multiply_elements(m, in, out, begin, end, parts); });
  return sum_parts(tables_.num_slices());
}

}  // namespace weft
