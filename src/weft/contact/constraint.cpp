#include "weft/contact/constraint.h"

#include <algorithm>
#include <cmath>

namespace weft::engine {
namespace {

constexpr double kPositionTolerance = 1e-6;  // corrections below need no further pass [m]
constexpr double kNear = 2;  // what has so many times the first pass' largest correction as room is left out
constexpr double kVelocityTolerance = 1e-4;  // [m/s]
constexpr int kVelocityPasses = 12;

/// Makes v_n >= 0; returns the squared change [m²/s²].
double stop_approach(Constraint& c, const std::vector<double>& inverse_masses,
                     std::vector<Vec3>& velocities) {
  const double speed = c.normal.dot(c.sum(velocities) - c.surface_velocity);
  const double impulse = std::max(0.0, c.impulse - speed / c.inverse_mass);
  const double change = impulse - c.impulse;
  if (change == 0) return 0;
  c.impulse = impulse;
  c.apply(change * c.normal, inverse_masses, velocities);
  return change * change * (c.inverse_mass * c.inverse_mass);
}

/// Friction against the slide; returns the squared change [m²/s²].
double slow_slide(Constraint& c, const std::vector<double>& inverse_masses, std::vector<Vec3>& velocities,
                  std::vector<Vec3>& slowed) {
  const double most = c.friction * c.impulse;
  if (most == 0 && c.friction_impulse.isZero(0)) return 0;
  const Vec3 relative = c.sum(velocities) - c.surface_velocity;
  const Vec3 slide = relative - relative.dot(c.normal) * c.normal;
  Vec3 impulse = c.friction_impulse - slide / c.inverse_mass;
  const double length = impulse.norm();
  impulse *= length > most ? most / length : 1.0;  // without a branch, which no processor could predict
  const Vec3 change = impulse - c.friction_impulse;
  c.friction_impulse = impulse;
  c.apply(change, inverse_masses, velocities);
  c.apply(change, inverse_masses, slowed);
  return change.squaredNorm() * (c.inverse_mass * c.inverse_mass);
}

}  // namespace

double project_positions(const std::vector<double>& inverse_masses, int passes,
                         std::vector<Constraint>& constraints, std::vector<Vec3>& positions,
                         std::vector<int>& near) {
  double first = 0, largest = 0;
  const auto project = [&](Constraint& c, double lack) {
    const double push = std::max(0.0, c.push + lack / c.inverse_mass);
    const double change = push - c.push;
    if (change == 0) return;
    c.push = push;
    c.is_active |= push > 0;
    c.apply(change * c.normal, inverse_masses, positions);
    largest = std::max(largest, std::abs(change) * c.inverse_mass);
  };
  const auto lack_of = [&](const Constraint& c) { return c.target - c.normal.dot(c.sum(positions)); };
  near.clear();
  for (int pass = 0; pass < passes; ++pass) {
    largest = 0;
    if (pass < 2) {
      for (int n = 0; n < static_cast<int>(constraints.size()); ++n) {
        Constraint& c = constraints[n];
        if (c.inverse_mass == 0) continue;
        const double lack = lack_of(c);
        if (pass == 1 && (c.push > 0 || lack > -kNear * first)) near.push_back(n);
        project(c, lack);
      }
    } else {
      for (const int n : near) project(constraints[n], lack_of(constraints[n]));
    }
    if (pass == 0) first = largest;
    if (largest < kPositionTolerance) break;
  }
  return first;
}

void project_velocities(const std::vector<double>& inverse_masses, std::vector<Constraint>& constraints,
                        std::vector<Vec3>& velocities, std::vector<Vec3>& slowed, std::vector<int>& active) {
  active.clear();
  for (int n = 0; n < static_cast<int>(constraints.size()); ++n) {
    if (constraints[n].is_active) active.push_back(n);
  }
  for (int pass = 0; pass < kVelocityPasses; ++pass) {
    double largest_sq = 0;
    for (const int n : active) {
      Constraint& c = constraints[n];
      largest_sq = std::max(largest_sq, stop_approach(c, inverse_masses, velocities));
      if (c.friction > 0)
        largest_sq = std::max(largest_sq, slow_slide(c, inverse_masses, velocities, slowed));
    }
    if (largest_sq < kVelocityTolerance * kVelocityTolerance) break;
  }
}

}  // namespace weft::engine
