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
  rows_.clear();
  estimates_.clear();
  active_.clear();
  points_.clear();
  for (const int n : which) {
    Contact& c = contacts[n];
    c.has_pushed = false;
    c.force.setZero();
    rows_.push_back({.weight = c.weight,
                     .normal = c.normal,
                     .stick_point = c.stick_point,
                     .offset = c.offset,
                     .stiffness = c.stiffness,
                     .num_particles = static_cast<std::int16_t>(c.num_particles),
                     .is_mutual = c.is_mutual()});
    estimates_.push_back(
        {.contact = &c, .coefficient = c.friction, .gap = c.gap, .lasting_force = c.lasting_force});
  }
  if (!rows_.empty()) find_points(members, step);
}

/// One for every particle of a contact.
void ContactTerms::find_points(std::span<const Member> members, double step) {
  for (const int particle : numbered_) number_[particle] = -1;
  numbered_.clear();
  const Member& last = members.back();
  const std::size_t size = last.first_particle + last.model->num_particles();
  if (number_.size() < size) number_.resize(size, -1);
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    Row& row = rows_[n];
    for (int k = 0; k < row.num_particles; ++k) {
      const int particle = estimates_[n].contact->particle[k];
      int& number = number_[particle];
      if (number < 0) {
        number = static_cast<int>(points_.size());
        numbered_.push_back(particle);
        points_.push_back(make_point(members, particle, step));
      }
      row.point[k] = number;
      row.can_move |= row.weight[k] != 0 && points_[number].mass_per_step > 0;
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

bool ContactTerms::any_active(std::span<const Positions> x) {
  gather(x);
  return std::any_of(rows_.begin(), rows_.end(), [&](const Row& row) { return row.depth(row.sum(x_)) > 0; });
}

/// Force estimate from the inertial prediction, the larger of two. One is the force that stops the particles,
/// shared among the contacts that bear the same particle: right under weight. The other is the force at the
/// depth so far, moved along with the surface: right under tension.
void ContactTerms::guess(std::span<const Positions> y) {
  gather(y);
  borne_.assign(points_.size(), 0.0);
  for (const Row& row : rows_) {
    if (row.depth(row.sum(x_)) == 0) continue;
    for (int k = 0; k < row.num_particles; ++k) borne_[row.point[k]] += row.weight[k] * row.weight[k];
  }
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    const Row& row = rows_[n];
    Estimate& e = estimates_[n];
    for (int k = 0; k < row.num_particles; ++k) {
      const int p = row.point[k];
      const double share = row.weight[k] * row.weight[k] / (borne_[p] > 0 ? borne_[p] : 1);
      e.inertia += share * points_[p].mass_per_step;
    }
    const Vec3 point = row.sum(x_), slide = row.slide(point);
    e.force = row.stiffness *
              std::max(e.inertia / (e.inertia + row.stiffness) * row.depth(point), e.contact->depth_before);
    // Mutual contacts: both sides are driven equally.
    Vec3 driven = row.is_mutual ? Vec3(Vec3::Zero()) : driven_;
    driven -= driven.dot(row.normal) * row.normal;
    e.slide = (slide - driven).norm();
    if (e.inertia > 0) e.slide = std::max(e.slide, slide.norm() - e.coefficient * e.force / e.inertia);
  }
}

/// Limit of the normal force that friction is based on [N].
double ContactTerms::most_push(const Estimate& e) {
  return std::max(kMaxOverGuess * e.stiffened * e.force, kMaxOverLasting * e.lasting_force);
}

/// µ N over the slide expected after the solve. At first that is the inertial slide less the part that
/// friction stops, but at least the slide at the start velocity: of the contacts that carry a sheet those
/// with a larger load must not lock. Later it is the slide so far, corrected for the friction error by
/// inertia only: without the correction, releasing stuck contacts would take many linearisations.
double ContactTerms::friction_stiffness(const Row& row, const Estimate& e, double depth, double slide) const {
  const double push = num_linearised_ < kGuesses ? e.force : std::min(row.stiffness * depth, most_push(e));
  const double most = e.coefficient * push;
  double expected = slide;
  if (num_linearised_ == 0)
    expected = e.slide;
  else if (row.friction > 0 && e.inertia > 0)
    expected = std::clamp(slide + (row.friction * slide - most) / e.inertia, kMinSlideRatio * slide,
                          kMaxSlideRatio * slide);
  return most / std::max(expected, sticking_);
}

/// On colliders a contact that presses harder than its limit has the friction of the limit, and no step
/// changes that. Between cloths its force counts: that friction is still to be found.
ContactTerms::Unrest ContactTerms::find_unrest(std::span<const Positions> x) {
  gather(x);
  double shortfall = 0, limits = 0, changes = 0, sum = 0;
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    const Row& row = rows_[n];
    const Vec3 point = row.sum(x_);
    const double depth = row.depth(point);
    if (!row.is_active && depth == 0) continue;
    const Estimate& e = estimates_[n];
    if (depth > 0 && row.can_move) shortfall = std::max(shortfall, depth / e.gap);
    const double push = row.stiffness * depth, slide = row.slide(point).norm(),
                 limit = e.coefficient * (row.is_mutual ? push : std::min(push, most_push(e)));
    const double change = limit * std::min(1.0, slide / sticking_) - row.friction * slide;
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
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    const Row& row = rows_[n];
    Contact& c = *estimates_[n].contact;
    c.has_pushed = row.has_pushed;
    c.is_solved = is_solved;
    c.push = row.stiffness * row.depth(row.sum(x_));
    if (c.push == 0) continue;
    for (int k = 0; k < row.num_particles; ++k) is_pushed[points_[row.point[k]].member] = 1;
  }
}

/// Whether an open contact will soon push: inertia presses cloth that lies on a collider, and barely touches
/// it, onto that collider.
bool ContactTerms::will_push(const Row& row, const Estimate& e, double beyond) {
  return e.force > 0 && !row.is_mutual && beyond > -kBarely * e.gap;
}

/// A contact's stiffness suits the inertia of its particles. Cloth that tension presses on a body needs more:
/// deeper than its gap, the surfaces would pass through each other.
void ContactTerms::stiffen(Row& row, Estimate& e) {
  const double factor = std::clamp(kMostStiff / (e.contact->stiffened * e.stiffened), 1.0, kStiffen);
  e.stiffened *= factor;
  row.stiffness *= factor;
}

double ContactTerms::linearise(std::span<const Positions> x, std::span<Vec3Array* const> force) {
  gather(x);
  double energy = 0;
  active_.clear();
  std::fill(f_.begin(), f_.end(), Vec3::Zero());
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    Row& row = rows_[n];
    Estimate& e = estimates_[n];
    const Vec3 point = row.sum(x_);
    const double beyond = row.beyond(point), depth = std::max(0.0, beyond);
    row.is_active = (depth > 0 || (num_linearised_ == 0 && will_push(row, e, beyond))) && row.can_move;
    if (!row.is_active) row.friction = 0;
    if (!row.is_active) continue;
    if (num_linearised_ > 0 && e.gap > 0 && depth > e.gap) stiffen(row, e);
    row.has_pushed |= depth > 0;
    const Vec3 slide = row.slide(point);
    row.friction = friction_stiffness(row, e, depth, slide.norm());
    const Vec3 push = row.stiffness * beyond * row.normal - row.friction * slide;
    for (int k = 0; k < row.num_particles; ++k) f_[row.point[k]] += row.weight[k] * push;
    active_.push_back({.point = row.point,
                       .weight = row.weight,
                       .normal = row.normal,
                       .stiffness = row.stiffness,
                       .friction = row.friction,
                       .num_particles = row.num_particles,
                       .is_mutual = row.is_mutual});
    energy += 0.5 * row.stiffness * depth * depth + 0.5 * row.friction * slide.squaredNorm();
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
  for (const Row& row : rows_) {
    const Vec3 point = row.sum(x_);
    const double depth = row.depth(point);
    energy += 0.5 * row.stiffness * depth * depth;
    if (row.is_active) energy += 0.5 * row.friction * row.slide(point).squaredNorm();
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
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    const Row& row = rows_[n];
    Contact& c = *estimates_[n].contact;
    const Vec3 point = row.sum(x_);
    if (row.can_move) c.force = row.stiffness * row.depth(point) * row.normal;
    if (row.is_active) c.force -= row.friction * row.slide(point);
    for (int k = 0; k < row.num_particles; ++k) f_[row.point[k]] += row.weight[k] * c.force;
    contacts.push_back(&c);
    at.push_back(row.point);
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
    const Vec3 product = (s.stiffness - s.friction) * s.normal.dot(sum) * s.normal + s.friction * sum;
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
  for (const Spring& s : active_) {
    for (int k = 0; k < s.num_particles; ++k) {
      const double share = s.weight[k] * s.weight[k];
      if (share == 0) continue;
      const Point& point = points_[s.point[k]];
      const auto& [stiff, along, preconditioner] = preconditioners[point.member];
      (*stiff)[point.at] += static_cast<float>(share * std::max(s.stiffness, s.friction));
      (*along)[point.at] += static_cast<float>(share * s.friction);
      preconditioner->add_normal(point.at, s.normal, stiff->size());
    }
  }
}

void ContactTerms::touch(FreeBodies& bodies) const {
  for (const Spring& s : active_) {
    std::array<FreeBodies::Place, 4> places;
    for (int k = 0; k < s.num_particles; ++k) {
      const Point& point = points_[s.point[k]];
      places[k] = {point.member, point.particle};
    }
    bodies.touch({places.data(), static_cast<std::size_t>(s.num_particles)}, s.is_mutual);
  }
}

}  // namespace weft::engine
