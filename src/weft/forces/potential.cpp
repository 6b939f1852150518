#include "weft/forces/potential.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "weft/forces/potential_kernels.h"

namespace weft::engine {
namespace {

/// Particles per chunk of work: enough to outweigh the cost of scheduling it.
constexpr int kGrain = 4096;

int rows_per_chunk(const PaddedRows& rows) { return std::max(1, kGrain / rows.row_length); }

}  // namespace

PaddedRows padded_rows_of(const ClothTopology& topology) {
  if (topology.grid) return {topology.grid->num_columns(), topology.grid->num_rows()};
  return {topology.num_particles(), 1};
}

void IncrementalPotential::fit(const ClothModel& model, double damping_rate) {
  damping_ = static_cast<float>(model.material.damping * damping_rate);
  damping_time_ = static_cast<float>(model.material.damping_time * damping_rate);
  is_projected_ = model.material.damping_kind == DampingKind::projected;
  if (model.id != model_id_) lay_out(model);
  elements_.fit(model, rows_, damping_rate);
  if (is_damped() && velocity_offset.size() == 0) velocity_offset = damped_ = Vec3Array(rows_.size());
}

void IncrementalPotential::lay_out(const ClothModel& model) {
  if (model.topology != topology_) {
    topology_ = model.topology;
    rows_ = padded_rows_of(*topology_);
    weight.assign(rows_.size(), 0.0f);
    for (Vec3Array* field : {&target, &x_}) *field = Vec3Array(rows_.size());
    velocity_offset = damped_ = Vec3Array();
    hessian_.clear();
    slope_.clear();
  }
  model_id_ = model.id;
  const ClothMaterial& m = model.material;
  has_springs_ = m.structural > 0 || m.shear > 0 || m.bend > 0 || m.damping > 0;
  if (topology_->grid) {
    fit_grid(model);
  } else {
    fit_mesh(model);
  }
}

void IncrementalPotential::fit_grid(const ClothModel& model) {
  const Grid& grid = *topology_->grid;
  const double dx = grid.spacing_x(), dz = grid.spacing_z(), diagonal = std::sqrt(dx * dx + dz * dz);
  const ClothMaterial& m = model.material;
  const int num_families = topology_->spring_model == SpringModel::simplified ? 5 : 6;
  has_soft_border_ = m.structural_z.has_value();
  num_families_ = has_springs_ ? num_families : 0;
  const double stiffness[] = {m.structural, m.structural_z.value_or(m.structural), m.shear, m.bend, m.bend,
                              m.shear};
  const double rest_length[] = {dx, dz, diagonal, 2 * dx, 2 * dz, diagonal};
  for (int f = 0; f < 6; ++f) {
    stiffness_[f] = static_cast<float>(stiffness[f]);
    rest_length_[f] = static_cast<float>(rest_length[f]);
  }
  spring_limit_ = model.elements ? model.elements->spring_limit : StrainLimit();
  peak_.assign(has_spring_limit() ? rows_.num_rows : 0, 0.0f);
  grid_stiffness_.clear();
  if (!model.has_equal_springs()) spread_grid_stiffness(model);
  if (!hessian_.empty()) return;
  hessian_.assign(kernels::GridPotential::hessian_size(rows_, num_families), 0.0f);
  slope_.assign(num_families * rows_.size() + kPackLanes, 0.0f);
  parts_.assign(rows_.num_rows, 0.0);
}

/// Copies every spring's stiffness to the kernels' layout: by family, at the owner.
void IncrementalPotential::spread_grid_stiffness(const ClothModel& model) {
  const int columns = rows_.row_length;
  grid_stiffness_.assign(num_families_ * rows_.size() + kPackLanes, 0.0f);
  const std::vector<Spring>& springs = topology_->springs;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    const int i = springs[s].i, j = springs[s].j;
    for (int f = 0; f < num_families_; ++f) {
      const kernels::FamilyOffset o = kernels::kFamilyOffsets[f];
      const bool is_own = j / columns - i / columns == o.rows && j % columns - i % columns == o.columns;
      if (is_own)
        grid_stiffness_[f * rows_.size() + rows_.index(i)] =
            static_cast<float>(model.stiffness(static_cast<int>(s)));
    }
  }
}

void IncrementalPotential::fit_mesh(const ClothModel& model) {
  const NeighbourTable& table = topology_->table;
  mesh_stiffness_ = model.entry_stiffness;
  if (!hessian_.empty()) return;
  hessian_.assign(4 * table.neighbour.size(), 0.0f);
  parts_.assign(table.num_slices(), 0.0);
  no_springs_.slice_begin.assign(table.slice_begin.size(), 0);
}

bool IncrementalPotential::compute_stiffening(std::vector<double>& added) const {
  if (!has_spring_limit()) return elements_.compute_stiffer_couplings(added);
  const std::vector<Spring>& springs = topology_->springs;
  added.assign(springs.size(), 0.0);
  if (*std::max_element(peak_.begin(), peak_.end()) <= spring_limit_.begin) return false;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    const Spring& spring = springs[s];
    if (spring.kind == SpringKind::bend) continue;
    const double length = (x_.get(rows_.index(spring.j)) - x_.get(rows_.index(spring.i))).norm();
    added[s] = limit_response(spring_limit_, length / spring.rest_length - 1).stiffness / spring.rest_length;
  }
  return true;
}

bool IncrementalPotential::is_beyond_limit() const {
  if (has_spring_limit()) return *std::max_element(peak_.begin(), peak_.end()) > spring_limit_.allowed();
  return elements_.has_limit() && elements_.peak_strain() > elements_.limit().allowed();
}

void IncrementalPotential::remember(const Vec3Array& x, const Vec3Array& displacement, double memory,
                                    JobSystem& jobs) {
  if (!elements_.is_damped()) return;
  for (int j = 0; j < rows_.num_rows; ++j) {
    const auto copy = [&](const float* from, const float* by, float* to, float* before) {
      for (int i = j * rows_.row_length, at = rows_.row(j); i < (j + 1) * rows_.row_length; ++i, ++at) {
        to[at] = from[i];
        before[at] = from[i] - by[i];
      }
    };
    copy(x.x(), displacement.x(), x_.x(), damped_.x());
    copy(x.y(), displacement.y(), x_.y(), damped_.y());
    copy(x.z(), displacement.z(), x_.z(), damped_.z());
  }
  elements_.remember(x_, damped_, memory, jobs);
}

/// x = y + e, and z = e + velocity_offset.
void IncrementalPotential::place(const Vec3Array& e, JobSystem& jobs) {
  const auto add = [&](const float* a, const float* b, float* sum) {
    parallel_for(jobs, static_cast<int>(rows_.size()), 4 * kGrain,
                 [&](int begin, int end) { kernels::add(a, b, sum, begin, end); });
  };
  add(target.x(), e.x(), x_.x());
  add(target.y(), e.y(), x_.y());
  add(target.z(), e.z(), x_.z());
  if (!is_damped()) return;
  add(e.x(), velocity_offset.x(), damped_.x());
  add(e.y(), velocity_offset.y(), damped_.y());
  add(e.z(), velocity_offset.z(), damped_.z());
}

double IncrementalPotential::sum_parts(int count) const {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += parts_[i];
  return sum;
}

kernels::GridPotential IncrementalPotential::grid_view(const Vec3Array& e) {
  return {.rows = rows_,
          .num_families = num_families_,
          .alternates = topology_->spring_model == SpringModel::alternating,
          .stiffness = stiffness_,
          .own_stiffness = grid_stiffness_.empty() ? nullptr : grid_stiffness_.data(),
          .rest_length = rest_length_,
          .has_soft_border = has_soft_border_,
          .limit = kernels::LimitNumbers(spring_limit_),
          .peak = peak_.data(),
          .damping = damping_,
          .damping_time = damping_time_,
          .is_projected = is_projected_,
          .weight = weight.data(),
          .x = kernels::rows(std::as_const(x_)),
          .offset = kernels::rows(e),
          .damped = kernels::rows(std::as_const(damped_)),
          .hessian = hessian_.data(),
          .slope = slope_.data()};
}

kernels::MeshPotential IncrementalPotential::mesh_view(const Vec3Array& e) {
  return {.table = has_springs_ ? &topology_->table : &no_springs_,
          .first = rows_.row(0),
          .num_particles = topology_->num_particles(),
          .stiffness = mesh_stiffness_.data(),
          .damping = damping_,
          .damping_time = damping_time_,
          .is_projected = is_projected_,
          .weight = weight.data(),
          .x = kernels::rows(std::as_const(x_)),
          .offset = kernels::rows(e),
          .damped = kernels::rows(std::as_const(damped_)),
          .hessian = hessian_.data()};
}

double IncrementalPotential::compute(const Vec3Array& e, JobSystem& jobs, Vec3Array* force) {
  place(e, jobs);
  const bool store = force != nullptr;
  double* parts = parts_.data();
  if (topology_->grid) {
    kernels::GridPotential g = grid_view(e);
    parallel_for(jobs, rows_.num_rows, rows_per_chunk(rows_),
                 [&](int begin, int end) { kernels::grid_springs(g, store, begin, end, parts); });
    if (store) {
      g.force = kernels::rows(*force);
      parallel_for(jobs, rows_.num_rows, rows_per_chunk(rows_),
                   [&](int begin, int end) { kernels::grid_forces(g, begin, end); });
    }
    return sum_parts(rows_.num_rows);
  }
  kernels::MeshPotential m = mesh_view(e);
  if (store) m.force = kernels::rows(*force);
  const int num_slices = topology_->table.num_slices();
  parallel_for(jobs, num_slices, kGrain / NeighbourTable::kLanes,
               [&](int begin, int end) { kernels::mesh_springs(m, store, begin, end, parts); });
  return sum_parts(num_slices);
}

double IncrementalPotential::energy(const Vec3Array& e, JobSystem& jobs) {
  const double springs = compute(e, jobs, nullptr);
  return elements_.empty() ? springs : springs + elements_.energy(x_, damped_, jobs);
}

double IncrementalPotential::linearise(const Vec3Array& e, JobSystem& jobs, Vec3Array& force) {
  const double springs = compute(e, jobs, &force);
  return elements_.empty() ? springs : springs + elements_.linearise(x_, damped_, jobs, force);
}

double IncrementalPotential::multiply(const Vec3Array& p, JobSystem& jobs, Vec3Array& q) {
  const double springs = multiply_springs(p, jobs, q);
  return elements_.empty() ? springs : springs + elements_.multiply(p, jobs, q);
}

double IncrementalPotential::multiply_springs(const Vec3Array& p, JobSystem& jobs, Vec3Array& q) {
  const kernels::ConstRows in = kernels::rows(p);
  const kernels::Rows out = kernels::rows(q);
  double* parts = parts_.data();
  if (topology_->grid) {
    const kernels::GridPotential g = grid_view(p);
    parallel_for(jobs, rows_.num_rows, rows_per_chunk(rows_),
                 [&](int begin, int end) { kernels::grid_multiply(g, in, out, begin, end, parts); });
    return sum_parts(rows_.num_rows);
  }
  const kernels::MeshPotential m = mesh_view(p);
  const int num_slices = topology_->table.num_slices();
  parallel_for(jobs, num_slices, kGrain / NeighbourTable::kLanes,
               [&](int begin, int end) { kernels::mesh_multiply(m, in, out, begin, end, parts); });
  return sum_parts(num_slices);
}

}  // namespace weft::engine
