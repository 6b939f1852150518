#include "weft/integrators/air_terms.h"

namespace weft::engine {

void AirTerms::begin(const Step& step) {
  rows_ = step.rows;
  air_ = find_air(step.model, step.state, step.environment.wind, step.environment.time);
}

void AirTerms::set_velocities(const Vec3Array& velocity, double rate) {
  rate_ = rate;
  slip_.resize(air_.velocity.size());
  for (std::size_t i = 0; i < slip_.size(); ++i) slip_[i] = air_.velocity[i] - velocity.get(i);
}

double AirTerms::energy(const Place& at, JobSystem&) {
  double sum = 0;
  for (int i = 0; i < static_cast<int>(slip_.size()); ++i) sum += energy(i, at.e.get(rows_.index(i)));
  return sum;
}

double AirTerms::linearise(const Place& at, JobSystem&, Vec3Array& force) {
  double sum = 0;
  for (int i = 0; i < static_cast<int>(slip_.size()); ++i) {
    const int row = rows_.index(i);
    const Vec3 e = at.e.get(row);
    sum += energy(i, e);
    const Vec3 own = air_.matrix[i] * (slip_[i] - rate_ * e);
    force.set(row, force.get(row) + own);
  }
  return sum;
}

double AirTerms::add_product(const Vec3Array& p, JobSystem&, Vec3Array& q) {
  double dot = 0;
  for (int i = 0; i < static_cast<int>(slip_.size()); ++i) {
    const int row = rows_.index(i);
    const Vec3 in = p.get(row), out = rate_ * (air_.matrix[i] * in);
    q.set(row, q.get(row) + out);
    dot += in.dot(out);
  }
  return dot;
}

}  // namespace weft::engine
