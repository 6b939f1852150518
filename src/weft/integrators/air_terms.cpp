#include "weft/integrators/air_terms.h"

namespace weft::engine {

void AirTerms::begin(const ClothModel& model, const Environment& environment, const ClothState& state) {
  matrix_.clear();
  const Wind& wind = environment.wind;
  if (wind.air.density == 0) return;
  const int n = model.num_particles();
  matrix_.assign(n, Mat3::Zero());
  air_.resize(n);
  slip_.resize(n);
  for (int i = 0; i < n; ++i)
    air_[i] = wind.velocity + gust_velocity(wind.gusts, state.position(i), environment.time);
  for (const auto& [a, b, c] : model.topology->mesh.triangles) {
    const Vec3 xa = state.x.get(a), xb = state.x.get(b), xc = state.x.get(c);
    const Vec3 area = 0.5 * (xb - xa).cross(xc - xa);
    const Vec3 slip = (air_[a] - state.v.get(a) + air_[b] - state.v.get(b) + air_[c] - state.v.get(c)) / 3;
    const Mat3 third = air_matrix(wind.air, area, slip) / 3;
    for (const int v : {a, b, c}) matrix_[v] += third;
  }
}

void AirTerms::set_velocities(const Vec3Array& velocity, double rate) {
  rate_ = rate;
  for (std::size_t i = 0; i < slip_.size(); ++i) slip_[i] = air_[i] - velocity.get(i);
}

void AirTerms::set_still(double rate) {
  rate_ = rate;
  slip_ = air_;
}

double AirTerms::energy(const PaddedRows& rows, const Vec3Array& e) const {
  double sum = 0;
  for (int i = 0; i < static_cast<int>(matrix_.size()); ++i) sum += energy(i, e.get(rows.index(i)));
  return sum;
}

double AirTerms::linearise(const PaddedRows& rows, const Vec3Array& e, Vec3Array& f) const {
  double sum = 0;
  for (int i = 0; i < static_cast<int>(matrix_.size()); ++i) {
    const int at = rows.index(i);
    const Vec3 offset = e.get(at);
    sum += energy(i, offset);
    f.set(at, f.get(at) + force(i, offset));
  }
  return sum;
}

double AirTerms::add_product(const PaddedRows& rows, const Vec3Array& p, Vec3Array& q) const {
  double dot = 0;
  for (int i = 0; i < static_cast<int>(matrix_.size()); ++i) {
    const int at = rows.index(i);
    const Vec3 in = p.get(at), out = rate_ * (matrix_[i] * in);
    q.set(at, q.get(at) + out);
    dot += in.dot(out);
  }
  return dot;
}

}  // namespace weft::engine
