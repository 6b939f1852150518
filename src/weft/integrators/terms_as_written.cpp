#include "weft/integrators/terms_as_written.h"

#include <algorithm>
#include <utility>

namespace weft::engine {

void TermsAsWritten::begin(const Step& step) {
  rows_ = step.rows;
  num_particles_ = step.model.num_particles();
  terms_ = make_terms_as_written(step.model, step.state);
  blocks_.clear();
  rank_ones_.clear();
}

std::vector<Vec3> TermsAsWritten::load(const Vec3Array& x) const {
  std::vector<Vec3> positions;
  positions.reserve(num_particles_);
  for (int i = 0; i < num_particles_; ++i) positions.push_back(x.get(rows_.index(i)));
  return positions;
}

double TermsAsWritten::energy(const Place& at, JobSystem&) {
  return terms_.empty() ? 0 : sum_energies(terms_, load(at.x));
}

bool TermsAsWritten::is_beyond_limit(const Vec3Array& x) const {
  if (terms_.empty()) return false;
  const std::vector<Vec3> positions = load(x);
  return std::ranges::any_of(terms_, [&](const auto& term) { return term->is_beyond_limit(positions); });
}

int TermsAsWritten::touch(int particle) {
  int& at = touched_at_[particle];
  if (at < 0) {
    at = static_cast<int>(touched_.size());
    touched_.push_back(particle);
  }
  return at;
}

double TermsAsWritten::linearise(const Place& at, JobSystem&, Vec3Array& force) {
  if (terms_.empty()) return 0;
  const std::vector<Vec3> x = load(at.x);
  blocks_.clear();
  rank_ones_.clear();
  touched_.clear();
  touched_at_.assign(num_particles_, -1);
  std::vector<Vec3> own(num_particles_, Vec3::Zero());
  add_forces(terms_, x, own);
  for (int i = 0; i < num_particles_; ++i) {
    const int row = rows_.index(i);
    if (!own[i].isZero(0)) force.set(row, force.get(row) + own[i]);
  }
  for (const auto& term : terms_) {
    term->add_hessian(x, HessianKind::positive, [&](int i, int j, const Mat3& block) {
      const int at_i = touch(i);
      blocks_.push_back({at_i, touch(j), block});
    });
    if (auto rank_one = term->rank_one(x)) rank_ones_.push_back(std::move(*rank_one));
  }
  return sum_energies(terms_, x);
}

double TermsAsWritten::add_product(const Vec3Array& p, JobSystem&, Vec3Array& q) {
  double dot = 0;
  const auto add = [&](int particle, const Vec3& value) {
    const int row = rows_.index(particle);
    q.set(row, q.get(row) + value);
    dot += p.get(row).dot(value);
  };
  if (!blocks_.empty()) {
    in_.clear();
    for (const int particle : touched_) in_.push_back(p.get(rows_.index(particle)));
    out_.assign(touched_.size(), Vec3::Zero());
    for (const auto& [i, j, block] : blocks_) {
      out_[i] += block * in_[j];
      if (i != j) out_[j] += block.transpose() * in_[i];
    }
    for (std::size_t k = 0; k < touched_.size(); ++k) add(touched_[k], out_[k]);
  }
  for (const auto& [stiffness, gradient] : rank_ones_) {
    double along = 0;
    for (int i = 0; i < num_particles_; ++i) along += gradient[i].dot(p.get(rows_.index(i)));
    for (int i = 0; i < num_particles_; ++i) add(i, stiffness * along * gradient[i]);
  }
  return dot;
}

}  // namespace weft::engine
