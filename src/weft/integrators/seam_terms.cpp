#include "weft/integrators/seam_terms.h"

namespace weft::engine {

void SeamTerms::begin(const ClothModel& model, const PaddedRows& rows, double step, ClothState& state) {
  model_ = &model;
  rows_ = rows;
  advance_seams(model, step, state);
  opening_ = seam_opening(model, state);
  pulled_.clear();
}

void SeamTerms::add(const SeamSpring& spring, const Vec3& force, Vec3Array& to) const {
  const auto weights = spring.weights();
  for (int k = 0; k < 3; ++k) {
    const int at = rows_.index(spring.particles[k]);
    to.set(at, to.get(at) + weights[k] * force);
  }
}

double SeamTerms::linearise(const Vec3Array& x, Vec3Array& force) {
  double energy = 0;
  pulled_.clear();
  visit_seam_pulls(
      *model_, opening_, [&](int v) { return x.get(rows_.index(v)); },
      [&](const SeamSpring& spring, const SeamPull& pull) {
        energy += pull.energy;
        add(spring, pull.force, force);
        pulled_.push_back({&spring, pull.hessian()});
      });
  return energy;
}

double SeamTerms::energy(const Vec3Array& x) const {
  double energy = 0;
  visit_seam_pulls(
      *model_, opening_, [&](int v) { return x.get(rows_.index(v)); },
      [&](const SeamSpring&, const SeamPull& pull) { energy += pull.energy; });
  return energy;
}

double SeamTerms::add_product(const Vec3Array& p, Vec3Array& q) const {
  double dot = 0;
  for (const auto& [spring, hessian] : pulled_) {
    const Vec3 along = seam_gap(*spring, [&](int v) { return p.get(rows_.index(v)); });
    const Vec3 product = hessian * along;
    add(*spring, product, q);
    dot += along.dot(product);
  }
  return dot;
}

}  // namespace weft::engine
