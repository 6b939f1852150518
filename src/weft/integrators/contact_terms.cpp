#include "weft/integrators/contact_terms.h"

#include <algorithm>
#include <cmath>

namespace weft::engine {
namespace {

constexpr double kStickSpeed = 1e-3;     // slower slides count as sticking [m/s]
constexpr int kGuesses = 2;              // linearisations with friction from estimated forces
constexpr double kMaxOverGuess = 3;      // … and after them, limit of forces over the estimate …
constexpr double kMaxOverLasting = 1.5;  // … and over the force of the last steps
constexpr double kMinSlideRatio = 0.7, kMaxSlideRatio = 1.5;  // bounds of the next slide over the last
constexpr double kBarely = 0.01;                              // of the gap: opening that counts as touching
constexpr double kStiffen = 4;  // factor for a contact that is deeper than its gap, per linearisation
constexpr double kFrictionChange = 0.02;  // tolerance of single contacts, as a share of the friction limit …
constexpr double kTotalFrictionChange = 0.05;  // … and of the sum over all

}  // namespace

void give_rest_to_contacts(std::span<const std::array<int, 4>> at, const std::vector<Vec3>& left,
                           const std::vector<char>& is_pinned, std::span<Contact* const> contacts) {
  std::vector<double> share(left.size(), 0);  // Σ w² over the contacts that push
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    const Contact& c = *contacts[n];
    if (c.force.isZero(0)) continue;
    for (int k = 0; k < c.num_particles; ++k) share[at[n][k]] += c.weight[k] * c.weight[k];
  }
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    Contact& c = *contacts[n];
    if (c.force.isZero(0)) continue;
    double sum = 0;
    Vec3 rest = Vec3::Zero();
    for (int k = 0; k < c.num_particles; ++k) {
      const double w = c.weight[k];
      if (w == 0 || is_pinned[at[n][k]]) continue;
      sum += std::abs(w);
      rest += w * std::abs(w) / share[at[n][k]] * left[at[n][k]];
    }
    if (sum > 0) c.force -= rest / sum;
  }
}

void ContactTerms::begin(std::span<Contact> contacts, std::span<const int> which,
                         std::span<const Member> members, double step, const Vec3& driven) {
  sticking_ = kStickSpeed * step;
  driven_ = driven;
  num_linearised_ = 0;
  terms_.clear();
  active_.clear();
  held_.clear();
  points_.clear();
  for (const int n : which) {
    contacts[n].has_pushed = false;
    contacts[n].force.setZero();
    terms_.push_back({.contact = &contacts[n]});
  }
  if (!terms_.empty()) find_points(members, step);
}

/// One for every particle of a contact.
void ContactTerms::find_points(std::span<const Member> members, double step) {
  for (const int particle : numbered_) number_[particle] = -1;
  numbered_.clear();
  const Member& last = members.back();
  const std::size_t size = last.first_particle + last.model->num_particles();
  if (number_.size() < size) number_.resize(size, -1);
  for (Term& t : terms_) {
    const Contact& c = *t.contact;
    for (int k = 0; k < c.num_particles; ++k) {
      int& number = number_[c.particle[k]];
      if (number < 0) {
        number = static_cast<int>(points_.size());
        numbered_.push_back(c.particle[k]);
        points_.push_back(make_point(members, c.particle[k], step));
      }
      t.point[k] = number;
      t.can_move |= c.weight[k] != 0 && points_[number].mass_per_step > 0;
    }
  }
  x_.resize(points_.size());
  f_.resize(points_.size());
}

ContactTerms::Point ContactTerms::make_point(std::span<const Member> members, int number, double step) {
  const auto after = std::upper_bound(members.begin(), members.end(), number,
                                      [](int i, const Member& m) { return i < m.first_particle; });
  const auto member = static_cast<int>(after - members.begin()) - 1;
  const Member& m = members[member];
  const int particle = number - m.first_particle;
  const std::vector<int>& pins = m.pins->particle;
  const bool is_pinned = std::binary_search(pins.begin(), pins.end(), particle);
  const double mass = is_pinned ? 0 : m.model->mass[particle];
  return {member, particle, m.rows->index(particle), mass / (step * step)};
}

void ContactTerms::gather(std::span<const Positions> x) {
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const auto& [target, offset] = x[points_[p].member];
    x_[p] = target->get(points_[p].at) + offset->get(points_[p].at);
  }
}

Vec3 ContactTerms::point_of(const Term& t) const {
  const Contact& c = *t.contact;
  Vec3 sum = c.weight[0] * x_[t.point[0]];
  for (int k = 1; k < c.num_particles; ++k) sum += c.weight[k] * x_[t.point[k]];
  return sum;
}

double ContactTerms::depth_of(const Term& t) const { return t.contact->depth_at(point_of(t)); }
Vec3 ContactTerms::slide_of(const Term& t) const { return t.contact->slide_at(point_of(t)); }

bool ContactTerms::any_active(std::span<const Positions> x) {
  gather(x);
  return std::any_of(terms_.begin(), terms_.end(), [&](const Term& t) { return depth_of(t) > 0; });
}

/// Force estimate from the inertial prediction, the larger of two. One is the force that stops the particles,
/// shared among the contacts that bear the same particle: right under weight. The other is the force at the
/// depth so far, moved along with the surface: right under tension.
void ContactTerms::guess(std::span<const Positions> y) {
  gather(y);
  borne_.assign(points_.size(), 0.0);
  for (const Term& t : terms_) {
    const Contact& c = *t.contact;
    if (depth_of(t) == 0) continue;
    for (int k = 0; k < c.num_particles; ++k) borne_[t.point[k]] += c.weight[k] * c.weight[k];
  }
  for (Term& t : terms_) {
    const Contact& c = *t.contact;
    for (int k = 0; k < c.num_particles; ++k) {
      const int p = t.point[k];
      const double share = c.weight[k] * c.weight[k] / (borne_[p] > 0 ? borne_[p] : 1);
      t.inertia += share * points_[p].mass_per_step;
    }
    t.guess = c.stiffness * std::max(t.inertia / (t.inertia + c.stiffness) * depth_of(t), c.depth_before);
    const Vec3 slide = slide_of(t);
    // Mutual contacts: both sides are driven equally.
    Vec3 driven = c.is_mutual() ? Vec3(Vec3::Zero()) : driven_;
    driven -= driven.dot(c.normal) * c.normal;
    t.slide = (slide - driven).norm();
    if (t.inertia > 0) t.slide = std::max(t.slide, slide.norm() - c.friction * t.guess / t.inertia);
  }
}

/// Limit of the normal force that friction is based on [N].
double ContactTerms::most_push(const Term& t) {
  return std::max(kMaxOverGuess * t.stiffened * t.guess, kMaxOverLasting * t.contact->lasting_force);
}

/// µ N over the slide expected after the solve. At first that is the inertial slide less the part that
/// friction stops, but at least the slide at the start velocity: of the contacts that carry a sheet those
/// with a larger load must not lock. Later it is the slide so far, corrected for the friction error by
/// inertia only: without the correction, releasing stuck contacts would take many linearisations.
double ContactTerms::friction_stiffness(const Term& t, double depth, double slide) const {
  const Contact& c = *t.contact;
  const double push = num_linearised_ < kGuesses ? t.guess : std::min(c.stiffness * depth, most_push(t));
  const double most = c.friction * push;
  double expected = slide;
  if (num_linearised_ == 0)
    expected = t.slide;
  else if (t.friction > 0 && t.inertia > 0)
    expected = std::clamp(slide + (t.friction * slide - most) / t.inertia, kMinSlideRatio * slide,
                          kMaxSlideRatio * slide);
  return most / std::max(expected, sticking_);
}

/// On colliders a contact that presses harder than its limit has the friction of the limit, and no step
/// changes that. Between cloths its force counts: that friction is still to be found.
ContactTerms::Unrest ContactTerms::find_unrest(std::span<const Positions> x) {
  gather(x);
  double shortfall = 0, limits = 0, changes = 0, sum = 0;
  for (const Term& t : terms_) {
    const Contact& c = *t.contact;
    const double depth = depth_of(t);
    if (depth > 0 && t.can_move) shortfall = std::max(shortfall, depth / c.gap);
    if (!t.is_active && depth == 0) continue;
    const double push = c.stiffness * depth;
    const double slide = slide_of(t).norm(),
                 limit = c.friction * (c.is_mutual() ? push : std::min(push, most_push(t)));
    const double change = limit * std::min(1.0, slide / sticking_) - t.friction * slide;
    limits += limit;
    changes += std::abs(change);
    sum += change;
  }
  const double per_limit = limits > 0 ? 1 / limits : 0;
  return {shortfall / kMaxShortfall, per_limit * changes / kFrictionChange,
          per_limit * std::abs(sum) / kTotalFrictionChange};
}

void ContactTerms::finish(std::span<const Positions> x, std::vector<char>& is_pushed) {
  const bool is_solved = find_unrest(x).shortfall <= 1;
  for (Term& t : terms_) {
    Contact& c = *t.contact;
    c.is_solved = is_solved;
    c.push = c.stiffness * depth_of(t);
    if (c.push == 0) continue;
    for (int k = 0; k < c.num_particles; ++k) is_pushed[points_[t.point[k]].member] = 1;
  }
}

/// Whether an open contact will soon push: inertia presses cloth that lies on a collider, and barely touches
/// it, onto that collider.
bool ContactTerms::will_push(const Term& t, double beyond) {
  const Contact& c = *t.contact;
  return t.guess > 0 && !c.is_mutual() && beyond > -kBarely * c.gap;
}

/// A contact's stiffness suits the inertia of its particles. Cloth that tension presses on a body needs more:
/// deeper than its gap, the surfaces would pass through each other.
void ContactTerms::stiffen(Term& t) {
  const double factor = std::clamp(kMostStiff / (t.contact->stiffened * t.stiffened), 1.0, kStiffen);
  t.stiffened *= factor;
  t.contact->stiffness *= factor;
}

double ContactTerms::linearise(std::span<const Positions> x, std::span<Vec3Array* const> force) {
  gather(x);
  double energy = 0;
  active_.clear();
  held_.clear();
  std::fill(f_.begin(), f_.end(), Vec3::Zero());
  for (std::size_t n = 0; n < terms_.size(); ++n) {
    Term& t = terms_[n];
    Contact& c = *t.contact;
    const double beyond = c.beyond(point_of(t)), depth = std::max(0.0, beyond);
    t.is_active = (depth > 0 || (num_linearised_ == 0 && will_push(t, beyond))) && t.can_move;
    if (!t.is_active) t.friction = 0;
    if (!t.is_active) continue;
    if (num_linearised_ > 0 && c.gap > 0 && depth > c.gap) stiffen(t);
    c.has_pushed |= depth > 0;
    held_.push_back(static_cast<int>(n));
    const Vec3 slide = slide_of(t);
    t.friction = friction_stiffness(t, depth, slide.norm());
    const Vec3 push = c.stiffness * beyond * c.normal - t.friction * slide;
    for (int k = 0; k < c.num_particles; ++k) f_[t.point[k]] += c.weight[k] * push;
    active_.push_back({.num_particles = c.num_particles,
                       .point = t.point,
                       .weight = c.weight,
                       .normal = c.normal,
                       .beyond_friction = c.stiffness - t.friction,
                       .friction = t.friction});
    energy += 0.5 * c.stiffness * depth * depth + 0.5 * t.friction * slide.squaredNorm();
  }
  ++num_linearised_;
  if (active_.empty()) return energy;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    Vec3Array& field = *force[points_[p].member];
    field.set(points_[p].at, field.get(points_[p].at) + f_[p]);
  }
  return energy;
}

double ContactTerms::energy(std::span<const Positions> x) {
  gather(x);
  double energy = 0;
  for (const Term& t : terms_) {
    const double depth = depth_of(t);
    energy += 0.5 * t.contact->stiffness * depth * depth;
    if (t.is_active) energy += 0.5 * t.friction * slide_of(t).squaredNorm();
  }
  return energy;
}

void ContactTerms::compute_forces(std::span<const Positions> x, std::span<const Vec3Array* const> others) {
  gather(x);
  std::vector<Contact*> contacts;
  std::vector<std::array<int, 4>> at;
  std::vector<char> is_pinned;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    f_[p] = others[points_[p].member]->get(points_[p].at);
    is_pinned.push_back(points_[p].mass_per_step == 0);
  }
  for (Term& t : terms_) {
    Contact& c = *t.contact;
    if (t.can_move) c.force = c.stiffness * depth_of(t) * c.normal;
    if (t.is_active) c.force -= t.friction * slide_of(t);
    for (int k = 0; k < c.num_particles; ++k) f_[t.point[k]] += c.weight[k] * c.force;
    contacts.push_back(&c);
    at.push_back(t.point);
  }
  give_rest_to_contacts(at, f_, is_pinned, contacts);
}

double ContactTerms::add_product(std::span<CgBlock* const> blocks) {
  if (active_.empty()) return 0;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    x_[p] = blocks[points_[p].member]->direction.get(points_[p].at);
    f_[p].setZero();
  }
  double dot = 0;
  for (const Spring& s : active_) {
    Vec3 sum = s.weight[0] * x_[s.point[0]];
    for (int k = 1; k < s.num_particles; ++k) sum += s.weight[k] * x_[s.point[k]];
    const Vec3 product = s.beyond_friction * s.normal.dot(sum) * s.normal + s.friction * sum;
    for (int k = 0; k < s.num_particles; ++k) f_[s.point[k]] += s.weight[k] * product;
    dot += sum.dot(product);
  }
  for (std::size_t p = 0; p < points_.size(); ++p) {
    Vec3Array& q = blocks[points_[p].member]->product;
    q.set(points_[p].at, q.get(points_[p].at) + f_[p]);
  }
  return dot;
}

void ContactTerms::add_to_preconditioners(std::span<const Preconditioners> preconditioners) const {
  for (const int n : held_) {
    const Term& t = terms_[n];
    const Contact& c = *t.contact;
    for (int k = 0; k < c.num_particles; ++k) {
      const double share = c.weight[k] * c.weight[k];
      if (share == 0) continue;
      const Point& point = points_[t.point[k]];
      const auto& [stiff, along, preconditioner] = preconditioners[point.member];
      (*stiff)[point.at] += static_cast<float>(share * std::max(c.stiffness, t.friction));
      (*along)[point.at] += static_cast<float>(share * t.friction);
      preconditioner->add_normal(point.at, c.normal, stiff->size());
    }
  }
}

void ContactTerms::touch(FreeBodies& bodies) const {
  for (const int n : held_) {
    const Term& t = terms_[n];
    std::array<FreeBodies::Place, 4> places;
    for (int k = 0; k < t.contact->num_particles; ++k) {
      const Point& point = points_[t.point[k]];
      places[k] = {point.member, point.particle};
    }
    bodies.touch({places.data(), static_cast<std::size_t>(t.contact->num_particles)}, t.contact->is_mutual());
  }
}

}  // namespace weft::engine
