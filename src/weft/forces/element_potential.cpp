#include "weft/forces/element_potential.h"

#include <algorithm>
#include <map>
#include <utility>

#include "weft/error.h"
#include "weft/forces/element_kernels.h"

namespace weft::engine {
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
    throw InputError(
        "newton supports curvature stencils only; build the elements with BendingModel::stencils");
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
  fit_stiffening(2 * kernels::kTangentSize * plane + kPackLanes, rows_.num_rows);
  past_.assign(6 * plane + kPackLanes, 0.0f);
  stress_.assign(6 * plane + kPackLanes, 0.0f);
  slope_.assign(4 * plane + kPackLanes, 0.0f);
  hessian_.clear();
  hessian_.assign(grid_view().hessian_size(), 0.0f);
  parts_.assign(rows_.num_rows, 0.0);
}

void ElementPotential::fit_mesh(const ClothModel& model) {
  tables_ = build_element_tables(*elements_, model.num_particles());
  const std::size_t patches = static_cast<std::size_t>(tables_.num_patch_slices()) * kPackLanes;
  fit_stiffening(MeshElements::kTangents * patches, tables_.num_patch_slices());
  past_.assign(6 * patches, 0.0f);
  stress_.assign(MeshElements::kFrameSize * patches, 0.0f);
  patch_.assign(MeshElements::kPatchSize * patches, 0.0f);
  hessian_.assign(static_cast<std::size_t>(tables_.num_entry_rows()) * kernels::kBlockSize * kPackLanes,
                  0.0f);
  parts_.assign(tables_.num_patch_slices() + tables_.num_slices(), 0.0);
}

void ElementPotential::fit_stiffening(std::size_t num_tangents, std::size_t num_peaks) {
  tangent_.assign(stiffens() ? num_tangents : 0, 0.0f);
  peak_.assign(stiffens() ? num_peaks : 0, 0.0f);
  triangle_couplings_.clear();
  if (!stiffens()) return;
  std::map<std::pair<int, int>, int> index;
  for (const Coupling& c : elements_->couplings)
    index.emplace(std::pair(c.i, c.j), static_cast<int>(index.size()));
  for (int t = 0; t < static_cast<int>(elements_->membranes.size()); ++t) {
    const auto& [vertices, rest] = elements_->membranes[t];
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3;
      const auto found = index.find(std::minmax(vertices[a], vertices[b]));
      if (found == index.end()) continue;
      triangle_couplings_.push_back({found->second, t, -rest.area * rest.gradient[a].dot(rest.gradient[b])});
    }
  }
}

double ElementPotential::peak_strain() const {
  return peak_.empty() ? 0.0 : static_cast<double>(*std::max_element(peak_.begin(), peak_.end()));
}

/// Half the trace of a triangle's stretching tangent, as (C11 + C22)/2 [N/m].
double ElementPotential::stiffening_rate(int triangle) const {
  constexpr int kD11 = 0, kD22 = 3;
  std::ptrdiff_t first = 0, pitch = kPackLanes;
  double curves = 0;
  if (is_grid_) {
    // The mesh lists the lower triangle first in a cell cut from a to d, the upper one in the others.
    const int cell = triangle / 2, cells_x = rows_.row_length - 1, i = cell % cells_x, j = cell / cells_x;
    const bool is_main = is_main_diagonal(diagonals_of(topology_->spring_model), i, j);
    const bool is_top = (triangle % 2 == 1) == is_main;
    pitch = static_cast<std::ptrdiff_t>(rows_.size());
    first = (is_top ? 0 : kernels::kTangentSize) * pitch + rows_.row(j) + i;
  } else {
    const int place = tables_.place_of_triangle[triangle], patch = place / 2;
    const int begin = patch / kPackLanes * (MeshElements::kTangents * kPackLanes) + patch % kPackLanes;
    curves = static_cast<double>(tangent_[begin]) + tangent_[begin + kPackLanes];
    first = begin + (2 + place % 2 * kernels::kTangentSize) * kPackLanes;
  }
  return 0.5 *
         (curves + static_cast<double>(tangent_[first + kD11 * pitch]) + tangent_[first + kD22 * pitch]);
}

bool ElementPotential::compute_stiffer_couplings(std::vector<double>& added) const {
  added.assign(elements_->couplings.size(), 0.0);
  if (!elements_->has_curves() && peak_strain() <= elements_->limit.begin) return false;
  for (const TriangleCoupling& c : triangle_couplings_)
    added[c.coupling] += c.share * stiffening_rate(c.triangle);
  for (double& stiffness : added) stiffness = std::max(stiffness, 0.0);
  return std::any_of(added.begin(), added.end(), [](double stiffness) { return stiffness > 0; });
}

static kernels::CurveNumbers numbers_of(const std::vector<StretchKink>& kinks) {
  kernels::CurveNumbers curve;
  for (const StretchKink& kink : kinks) {
    curve.strain[curve.count] = static_cast<float>(kink.strain);
    curve.slope[curve.count++] = static_cast<float>(kink.slope);
  }
  return curve;
}

static kernels::StiffeningNumbers stiffening_of(const StrainLimit& limit,
                                                const std::vector<StretchKink>& along_1,
                                                const std::vector<StretchKink>& along_2) {
  return {kernels::LimitNumbers(limit), numbers_of(along_1), numbers_of(along_2)};
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
          .stiffening =
              stiffening_of(elements_->limit, is_along_x ? elements_->stretch_warp : elements_->stretch_weft,
                            is_along_x ? elements_->stretch_weft : elements_->stretch_warp),
          .tangent = tangent_.data(),
          .peak = peak_.data(),
          .bending = bending_.data(),
          .past = past_.data(),
          .stress = stress_.data(),
          .slope = slope_.data(),
          .hessian = hessian_.data()};
}

MeshElements ElementPotential::mesh_view() {
  const float stiffening = 1 + damping_;
  const PatchDifference& difference = elements_->difference;
  const Mat3& c = elements_->stiffness;
  return {.first = rows_.row(0),
          .membrane = {stiffening * static_cast<float>(c(0, 0)), stiffening * static_cast<float>(c(1, 1)),
                       stiffening * static_cast<float>(c(0, 1)), stiffening * static_cast<float>(c(2, 2))},
          .difference = {stiffening * static_cast<float>(difference.stiffness),
                         static_cast<float>(difference.begin), static_cast<float>(difference.warp),
                         static_cast<float>(difference.weft)},
          .damping = damping_,
          .stiffening = stiffening_of(elements_->limit, elements_->stretch_warp, elements_->stretch_weft),
          .tangent = tangent_.data(),
          .peak = peak_.data(),
          .corner = tables_.corner.data(),
          .shape = tables_.shape.data(),
          .past = past_.data(),
          .frame = stress_.data(),
          .patch = patch_.data(),
          .slice_begin = tables_.slice_begin.data(),
          .neighbour = tables_.neighbour.data(),
          .coupling = tables_.coupling.data(),
          .bending = tables_.bending.data(),
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
  parallel_for(jobs, tables_.num_patch_slices(), kSlicesPerChunk,
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
  double* bending = parts + tables_.num_patch_slices();
  parallel_for(jobs, tables_.num_patch_slices(), kSlicesPerChunk,
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
  parallel_for(jobs, tables_.num_patch_slices(), kSlicesPerChunk,
               [&](int begin, int end) { kernels::mesh_patches(m, begin, end); });
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

}  // namespace weft::engine
