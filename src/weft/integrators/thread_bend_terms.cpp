#include "weft/integrators/thread_bend_terms.h"

namespace weft::engine {
namespace {

constexpr int kGrain = 512;  // rows or particles per job

}  // namespace

void ThreadBendTerms::begin(const Step& step) {
  const ClothModel& model = step.model;
  step_ = begin_thread_bends(thread_bends_of(model), model.topology->mesh, step.state);
  if (num_rows() == 0 || model.id == model_id_) return;
  model_id_ = model.id;
  padded_.clear();
  for (int i = 0; i < model.num_particles(); ++i) padded_.push_back(step.rows.index(i));
  for (std::vector<double>* values : {&stiffness_, &moment_, &part_}) values->assign(num_rows(), 0.0);
  transpose(model.num_particles());
}

void ThreadBendTerms::transpose(int num_particles) {
  const ThreadBends& rows = *step_.rows;
  first_entry_.assign(num_particles + 1, 0);
  for (const int v : rows.vertex) ++first_entry_[v + 1];
  for (int v = 0; v < num_particles; ++v) first_entry_[v + 1] += first_entry_[v];
  entry_row_.resize(rows.vertex.size());
  entry_weight_.resize(rows.vertex.size());
  std::vector<int> next(first_entry_.begin(), first_entry_.end() - 1);
  for (int r = 0; r < num_rows(); ++r) {
    for (int k = rows.begin[r]; k < rows.begin[r + 1]; ++k) {
      const int entry = next[rows.vertex[k]]++;
      entry_row_[entry] = r;
      entry_weight_[entry] = rows.weight[k];
    }
  }
}

double ThreadBendTerms::sum_parts() const {
  double sum = 0;
  for (const double part : part_) sum += part;
  return sum;
}

double ThreadBendTerms::curvature(int row, const Vec3Array& x) const {
  return thread_curvature(step_, row, [&](int v) { return x.get(padded_[v]); });
}

/// to += sign · Σ moment w n over the rows of each particle.
void ThreadBendTerms::scatter(JobSystem& jobs, double sign, Vec3Array& to) const {
  parallel_for(jobs, static_cast<int>(padded_.size()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      if (first_entry_[i] == first_entry_[i + 1]) continue;
      Vec3 sum = Vec3::Zero();
      for (int k = first_entry_[i]; k < first_entry_[i + 1]; ++k)
        sum += entry_weight_[k] * moment_[entry_row_[k]] * step_.normal[entry_row_[k]];
      to.set(padded_[i], to.get(padded_[i]) + sign * sum);
    }
  });
}

double ThreadBendTerms::linearise(const Place& at, JobSystem& jobs, Vec3Array& force) {
  if (num_rows() == 0) return 0;
  parallel_for(jobs, num_rows(), kGrain, [&](int begin, int end) {
    for (int r = begin; r < end; ++r) {
      const auto response = thread_bend_response(step_, r, curvature(r, at.x));
      part_[r] = response.energy;
      moment_[r] = response.moment;
      stiffness_[r] = response.stiffness;
    }
  });
  scatter(jobs, -1, force);
  return sum_parts();
}

double ThreadBendTerms::energy(const Place& at, JobSystem& jobs) {
  if (num_rows() == 0) return 0;
  parallel_for(jobs, num_rows(), kGrain, [&](int begin, int end) {
    for (int r = begin; r < end; ++r) part_[r] = thread_bend_response(step_, r, curvature(r, at.x)).energy;
  });
  return sum_parts();
}

double ThreadBendTerms::add_product(const Vec3Array& p, JobSystem& jobs, Vec3Array& q) {
  if (num_rows() == 0) return 0;
  parallel_for(jobs, num_rows(), kGrain, [&](int begin, int end) {
    for (int r = begin; r < end; ++r) {
      const double along = curvature(r, p);
      moment_[r] = stiffness_[r] * along;
      part_[r] = moment_[r] * along;
    }
  });
  scatter(jobs, 1, q);
  return sum_parts();
}

}  // namespace weft::engine
