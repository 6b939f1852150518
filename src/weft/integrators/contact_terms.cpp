#include "weft/integrators/contact_terms.h"

#include <algorithm>

namespace weft {
namespace {

constexpr double kStickSpeed = 1e-3;  // slower slides count as sticking [m/s]

}  // namespace

void ContactTerms::begin(const std::vector<Contact>& contacts, const ClothModel& model,
                         const PinTargets& pins, double step) {
  sticking_ = kStickSpeed * step;
  is_first_ = true;
  terms_.clear();
  for (const Contact& c : contacts) {
    double inverse_mass = 0;
    for (int k = 0; k < c.num_particles; ++k) {
      const bool is_pinned =
          std::binary_search(pins.particle.begin(), pins.particle.end(), c.particle[k]);
      if (!is_pinned) inverse_mass += c.weight[k] * c.weight[k] / model.mass[c.particle[k]];
    }
    Term term;
    term.contact = &c;
    term.inertia_share = 1 / (1 + c.stiffness * step * step * inverse_mass);
    terms_.push_back(term);
  }
}

bool ContactTerms::any_active(const OffsetPositions& x) const {
  return std::any_of(terms_.begin(), terms_.end(), [&](const Term& t) { return t.contact->depth(x) > 0; });
}

double ContactTerms::friction_length(double slide) const {
  return slide < sticking_ ? 0.5 * slide * slide / sticking_ : slide - 0.5 * sticking_;
}

/// At first the particles still are where inertia alone would take them: friction then goes by the force that
/// stops a lone stencil.
double ContactTerms::linearise(const OffsetPositions& x, Vec3Array& force) {
  double energy = 0;
  for (Term& t : terms_) {
    const Contact& c = *t.contact;
    const double depth = c.depth(x);
    t.is_active = depth > 0;
    t.normal_force = (is_first_ ? t.inertia_share : 1.0) * c.stiffness * depth;
    if (!t.is_active) continue;
    const Vec3 slide = c.slide(x);
    compute_hessian(t, slide);
    const double friction = c.friction * t.normal_force / std::max(slide.norm(), sticking_);
    const Vec3 push = c.stiffness * depth * c.normal - friction * slide;
    for (int k = 0; k < c.num_particles; ++k) {
      const int at = x.rows.index(c.particle[k]);
      force.set(at, force.get(at) + c.weight[k] * push);
    }
    energy += 0.5 * c.stiffness * depth * depth + c.friction * t.normal_force * friction_length(slide.norm());
  }
  is_first_ = false;
  return energy;
}

/// Along the normal the contact's stiffness, across it that of friction; a slide that is under way resists
/// only sideways.
void ContactTerms::compute_hessian(Term& t, const Vec3& slide) const {
  const Contact& c = *t.contact;
  const Mat3 normal = c.normal * c.normal.transpose();
  const double length = slide.norm();
  const double friction = c.friction * t.normal_force / std::max(length, sticking_);
  Mat3 across = Mat3::Identity() - normal;
  if (length > sticking_) across -= slide * slide.transpose() / (length * length);
  t.hessian = c.stiffness * normal + friction * across;
  t.stiffness = std::max(c.stiffness, friction);
}

double ContactTerms::energy(const OffsetPositions& x) const {
  double energy = 0;
  for (const Term& t : terms_) {
    const double depth = t.contact->depth(x);
    energy += 0.5 * t.contact->stiffness * depth * depth;
    if (t.normal_force > 0)
      energy += t.contact->friction * t.normal_force * friction_length(t.contact->slide(x).norm());
  }
  return energy;
}

double ContactTerms::add_product(const PaddedRows& rows, const Vec3Array& p, Vec3Array& q) const {
  double dot = 0;
  for (const Term& t : terms_) {
    if (!t.is_active) continue;
    const Contact& c = *t.contact;
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < c.num_particles; ++k) sum += c.weight[k] * p.get(rows.index(c.particle[k]));
    const Vec3 product = t.hessian * sum;
    for (int k = 0; k < c.num_particles; ++k) {
      const int at = rows.index(c.particle[k]);
      q.set(at, q.get(at) + c.weight[k] * product);
    }
    dot += sum.dot(product);
  }
  return dot;
}

void ContactTerms::add_stiffness(const PaddedRows& rows, std::vector<float>& diagonal) const {
  for (const Term& t : terms_) {
    if (!t.is_active) continue;
    for (int k = 0; k < t.contact->num_particles; ++k) {
      const double w = t.contact->weight[k];
      diagonal[rows.index(t.contact->particle[k])] += static_cast<float>(w * w * t.stiffness);
    }
  }
}

}  // namespace weft
