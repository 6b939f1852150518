#include "weft/integrators/contact_terms.h"

#include <algorithm>
#include <cmath>

namespace weft {
namespace {

constexpr double kStickSpeed = 1e-3;  // slower slides count as sticking [m/s]
constexpr int kGuesses = 2;           // linearisations for which friction goes by guessed forces
constexpr double kMostOfGuess = 1.5;  // … and then by no more than so many times as much

}  // namespace

void give_rest_to_contacts(std::span<const Contact* const> contacts, const std::vector<Vec3>& left,
                           std::vector<Vec3>& forces) {
  std::vector<double> share(left.size(), 0);  // Σ w² over the contacts that push
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    if (forces[n].isZero(0)) continue;
    for (int k = 0; k < contacts[n]->num_particles; ++k)
      share[contacts[n]->particle[k]] += contacts[n]->weight[k] * contacts[n]->weight[k];
  }
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    if (forces[n].isZero(0)) continue;
    const Contact& c = *contacts[n];
    double sum = 0;
    Vec3 rest = Vec3::Zero();
    for (int k = 0; k < c.num_particles; ++k) {
      const double w = c.weight[k];
      sum += std::abs(w);
      if (w != 0) rest += w * std::abs(w) / share[c.particle[k]] * left[c.particle[k]];
    }
    forces[n] -= rest / sum;
  }
}

void ContactTerms::begin(const std::vector<Contact>& contacts, const ClothModel& model,
                         const PinTargets& pins, double step, const Vec3& driven) {
  sticking_ = kStickSpeed * step;
  driven_ = driven;
  num_linearised_ = 0;
  terms_.clear();
  active_.clear();
  have_pushed_.assign(contacts.size(), 0);
  if (contacts.empty()) return;
  mass_per_step_.clear();
  for (const double m : model.mass) mass_per_step_.push_back(m / (step * step));
  for (const int p : pins.particle) mass_per_step_[p] = 0;
  for (const Contact& c : contacts) {
    Term term{.contact = &c};
    for (int k = 0; k < c.num_particles; ++k)
      term.can_move |= c.weight[k] != 0 && mass_per_step_[c.particle[k]] > 0;
    terms_.push_back(term);
  }
}

bool ContactTerms::any_active(const OffsetPositions& x) const {
  return std::any_of(terms_.begin(), terms_.end(), [&](const Term& t) { return t.contact->depth(x) > 0; });
}

/// From where inertia alone has taken the particles: the larger of what stops them, where many contacts bear
/// the same particle each its share, which is right where weight presses, and of what pressed at the depth so
/// far, carried along by the surface, which is right where tension does.
void ContactTerms::guess_forces(const OffsetPositions& x) {
  borne_.assign(mass_per_step_.size(), 0.0);
  for (const Term& t : terms_) {
    const Contact& c = *t.contact;
    if (c.depth(x) == 0) continue;
    for (int k = 0; k < c.num_particles; ++k) borne_[c.particle[k]] += c.weight[k] * c.weight[k];
  }
  for (Term& t : terms_) {
    const Contact& c = *t.contact;
    for (int k = 0; k < c.num_particles; ++k) {
      const int p = c.particle[k];
      if (borne_[p] > 0) t.inertia += c.weight[k] * c.weight[k] / borne_[p] * mass_per_step_[p];
    }
    t.guess = c.stiffness * std::max(t.inertia / (t.inertia + c.stiffness) * c.depth(x), c.depth_before);
  }
}

/// µ N over the slide that is expected after the solve: the present one. At first the slide is what friction
/// leaves of inertia's, but not less than if the velocity at the start went on: of the contacts that carry a
/// sheet those that bear more must not hold it fast.
double ContactTerms::friction_stiffness(const Term& t, double depth, const Vec3& slide) const {
  const Contact& c = *t.contact;
  const double push =
      num_linearised_ < kGuesses ? t.guess : std::min(c.stiffness * depth, kMostOfGuess * t.guess);
  const double most = c.friction * push;
  double expected = slide.norm();
  if (num_linearised_ == 0) {
    const Vec3 driven = driven_ - driven_.dot(c.normal) * c.normal;
    expected = std::max(expected - most / t.inertia, (slide - driven).norm());
  }
  return most / std::max(expected, sticking_);
}

double ContactTerms::linearise(const OffsetPositions& x, Vec3Array& force) {
  if (num_linearised_ == 0) guess_forces(x);
  double energy = 0;
  active_.clear();
  for (std::size_t n = 0; n < terms_.size(); ++n) {
    Term& t = terms_[n];
    const Contact& c = *t.contact;
    const double depth = c.depth(x);
    t.is_active = depth > 0 && t.can_move;
    if (!t.is_active) t.friction = 0;
    if (!t.is_active) continue;
    have_pushed_[n] = 1;
    const Vec3 slide = c.slide(x);
    t.friction = friction_stiffness(t, depth, slide);
    const Vec3 push = c.stiffness * depth * c.normal - t.friction * slide;
    Spring spring{.num_particles = c.num_particles,
                  .weight = c.weight,
                  .normal = c.normal,
                  .beyond_friction = c.stiffness - t.friction,
                  .friction = t.friction};
    for (int k = 0; k < c.num_particles; ++k) {
      const int at = spring.at[k] = x.rows.index(c.particle[k]);
      force.set(at, force.get(at) + c.weight[k] * push);
    }
    active_.push_back(spring);
    energy += 0.5 * c.stiffness * depth * depth + 0.5 * t.friction * slide.squaredNorm();
  }
  ++num_linearised_;
  return energy;
}

double ContactTerms::energy(const OffsetPositions& x) const {
  double energy = 0;
  for (const Term& t : terms_) {
    const double depth = t.contact->depth(x);
    energy += 0.5 * t.contact->stiffness * depth * depth;
    if (t.is_active) energy += 0.5 * t.friction * t.contact->slide(x).squaredNorm();
  }
  return energy;
}

void ContactTerms::compute_forces(const OffsetPositions& x, const Vec3Array& others,
                                  std::vector<Vec3>& forces) const {
  forces.clear();
  std::vector<const Contact*> contacts;
  int num_particles = 0;
  for (const Term& t : terms_) {
    const Contact& c = *t.contact;
    Vec3 force = Vec3::Zero();
    if (t.can_move) force = c.stiffness * c.depth(x) * c.normal;
    if (t.is_active) force -= t.friction * c.slide(x);
    forces.push_back(force);
    contacts.push_back(&c);
    for (int k = 0; k < c.num_particles; ++k) num_particles = std::max(num_particles, c.particle[k] + 1);
  }
  std::vector<Vec3> left;
  for (int i = 0; i < num_particles; ++i) left.push_back(others.get(x.rows.index(i)));
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    const Contact& c = *contacts[n];
    for (int k = 0; k < c.num_particles; ++k) left[c.particle[k]] += c.weight[k] * forces[n];
  }
  give_rest_to_contacts(contacts, left, forces);
}

double ContactTerms::add_product(const Vec3Array& p, Vec3Array& q) const {
  double dot = 0;
  for (const Spring& s : active_) {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < s.num_particles; ++k) sum += s.weight[k] * p.get(s.at[k]);
    const Vec3 product = s.beyond_friction * s.normal.dot(sum) * s.normal + s.friction * sum;
    for (int k = 0; k < s.num_particles; ++k) q.set(s.at[k], q.get(s.at[k]) + s.weight[k] * product);
    dot += sum.dot(product);
  }
  return dot;
}

void ContactTerms::add_to_preconditioners(const PaddedRows& rows, std::vector<float>& stiff,
                                          std::vector<float>& along, ContactFilter& filter) const {
  for (const Term& t : terms_) {
    if (!t.is_active) continue;
    const Contact& c = *t.contact;
    for (int k = 0; k < c.num_particles; ++k) {
      const double share = c.weight[k] * c.weight[k];
      if (share == 0) continue;
      const int at = rows.index(c.particle[k]);
      stiff[at] += static_cast<float>(share * std::max(c.stiffness, t.friction));
      along[at] += static_cast<float>(share * t.friction);
      filter.hold(rows, c.particle[k], c.normal);
    }
  }
}

}  // namespace weft
