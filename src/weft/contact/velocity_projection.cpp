#include "weft/contact/velocity_projection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "weft/core/simd.h"

namespace weft::engine {
namespace {

constexpr double kVelocityTolerance = 1e-4;  // [m/s]
constexpr int kVelocityPasses = 12;
constexpr double kSmallest = std::numeric_limits<double>::denorm_min();

using Row = VelocityProjection::Row;

WEFT_ALWAYS_INLINE Quad operator*(double s, const Quad& q) {
  Quad r;
  for (int k = 0; k < 4; ++k) r.at[k] = s * q.at[k];
  return r;
}
WEFT_ALWAYS_INLINE Quad operator/(const Quad& q, double s) {
  Quad r;
  for (int k = 0; k < 4; ++k) r.at[k] = q.at[k] / s;
  return r;
}
WEFT_ALWAYS_INLINE Quad operator+(const Quad& p, const Quad& q) {
  Quad r;
  for (int k = 0; k < 4; ++k) r.at[k] = p.at[k] + q.at[k];
  return r;
}
WEFT_ALWAYS_INLINE Quad operator-(const Quad& p, const Quad& q) {
  Quad r;
  for (int k = 0; k < 4; ++k) r.at[k] = p.at[k] - q.at[k];
  return r;
}
WEFT_ALWAYS_INLINE double dot(const Quad& p, const Quad& q) {
  Quad r;
  for (int k = 0; k < 4; ++k) r.at[k] = p.at[k] * q.at[k];
  return r.at[0] + (r.at[1] + r.at[2]);  // as Eigen
}

template <int kVertices>
WEFT_ALWAYS_INLINE Quad relative_velocity(const Row& row, const Quad* velocities) {
  Quad sum = row.weight[0] * velocities[row.vertex[0]];
  for (int k = 1; k < kVertices; ++k) sum = sum + row.weight[k] * velocities[row.vertex[k]];
  return sum - row.surface_velocity;
}

template <int kVertices>
WEFT_ALWAYS_INLINE void apply(const Row& row, const Quad& impulse, Quad* values) {
  for (int k = 0; k < kVertices; ++k)
    values[row.vertex[k]] = values[row.vertex[k]] + row.response[k] * impulse;
}

/// Makes v_n >= 0; returns the squared change [m²/s²].
template <int kVertices>
WEFT_ALWAYS_INLINE double stop_approach(Row& row, Quad* velocities) {
  const double speed = dot(row.normal, relative_velocity<kVertices>(row, velocities));
  const double impulse = std::max(0.0, row.impulse - speed / row.inverse_mass);
  const double change = impulse - row.impulse;
  if (change == 0) return 0;
  row.impulse = impulse;
  apply<kVertices>(row, change * row.normal, velocities);
  return change * change * (row.inverse_mass * row.inverse_mass);
}

/// Friction against sliding; returns the squared change [m²/s²].
template <int kVertices>
WEFT_ALWAYS_INLINE double slow_slide(Row& row, Quad* velocities, Quad* slowed) {
  const double most = row.friction * row.impulse;
  const auto& before = row.friction_impulse.at;
  if (most == 0 && before[0] == 0 && before[1] == 0 && before[2] == 0) return 0;
  const Quad relative = relative_velocity<kVertices>(row, velocities);
  const Quad slide = relative - dot(relative, row.normal) * row.normal;
  Quad impulse = row.friction_impulse - slide / row.inverse_mass;
  const double length = std::sqrt(dot(impulse, impulse));
  // Clamped to µ P; for several vertices without a branch, which processors cannot predict.
  if (kVertices > 1)
    impulse = most / std::max(length, std::max(most, kSmallest)) * impulse;
  else if (length > most)
    impulse = most / length * impulse;
  const Quad change = impulse - row.friction_impulse;
  row.friction_impulse = impulse;
  apply<kVertices>(row, change, velocities);
  apply<kVertices>(row, change, slowed);
  return dot(change, change) * (row.inverse_mass * row.inverse_mass);
}

template <int kVertices>
WEFT_ALWAYS_INLINE double relax(Row& row, Quad* velocities, Quad* slowed) {
  const double stopped = stop_approach<kVertices>(row, velocities);
  return row.friction > 0 ? std::max(stopped, slow_slide<kVertices>(row, velocities, slowed)) : stopped;
}

/// One pass over all rows; `largest_sq` receives the largest squared change [m²/s²].
WEFT_ALWAYS_INLINE void relax_all_body(std::span<Row> rows, Quad* velocities, Quad* slowed,
                                       double& largest_sq) {
  double largest = 0;
  for (Row& row : rows) {
    const double change_sq = row.num_vertices == 1   ? relax<1>(row, velocities, slowed)
                             : row.num_vertices == 3 ? relax<3>(row, velocities, slowed)
                                                     : relax<4>(row, velocities, slowed);
    largest = std::max(largest, change_sq);
  }
  largest_sq = largest;
}
WEFT_MULTIVERSION(relax_all, (std::span<Row> rows, Quad* velocities, Quad* slowed, double& largest_sq),
                  (rows, velocities, slowed, largest_sq))

Row make_row(const Constraint& c, int number, const std::vector<double>& inverse_masses) {
  Row row;
  row.normal = to_quad(c.normal);
  row.surface_velocity = to_quad(c.surface_velocity);
  row.friction_impulse = to_quad(c.friction_impulse);
  row.weight = c.weight;
  row.vertex = c.vertex;
  row.num_vertices = c.num_vertices;
  row.constraint = number;
  row.inverse_mass = c.inverse_mass;
  row.friction = c.friction;
  row.impulse = c.impulse;
  for (int k = 0; k < c.num_vertices; ++k) row.response[k] = c.weight[k] * inverse_masses[c.vertex[k]];
  return row;
}

void store(const Row& row, Constraint& c) {
  c.impulse = row.impulse;
  c.friction_impulse = row.friction_impulse.to_vec3();
}

}  // namespace

void VelocityProjection::schedule(const std::vector<double>& inverse_masses,
                                  const std::vector<Constraint>& constraints) {
  active_.clear();
  level_.clear();
  level_begin_.clear();
  next_level_.resize(inverse_masses.size(), 0);
  for (int n = 0; n < static_cast<int>(constraints.size()); ++n) {
    const Constraint& c = constraints[n];
    if (!c.is_active || c.is_alone) continue;
    const std::span vertices(c.vertex.data(), c.num_vertices);
    int level = 0;
    for (const int v : vertices) level = std::max(level, next_level_[v]);
    for (const int v : vertices) next_level_[v] = level + 1;
    if (level == static_cast<int>(level_begin_.size())) level_begin_.push_back(0);
    ++level_begin_[level];
    active_.push_back(n);
    level_.push_back(level);
  }
  int begin = 0;
  for (int& level : level_begin_) level = std::exchange(begin, begin + level);
  rows_.resize(active_.size());
  for (std::size_t a = 0; a < active_.size(); ++a) {
    const Constraint& c = constraints[active_[a]];
    rows_[level_begin_[level_[a]]++] = make_row(c, active_[a], inverse_masses);
    for (int k = 0; k < c.num_vertices; ++k) next_level_[c.vertex[k]] = 0;
  }
}

void VelocityProjection::project(const std::vector<double>& inverse_masses,
                                 std::vector<Constraint>& constraints, std::vector<Quad>& velocities,
                                 std::vector<Quad>& slowed) {
  for (Constraint& c : constraints) {
    if (!c.is_active || !c.is_alone) continue;
    Row row = make_row(c, 0, inverse_masses);
    relax<1>(row, velocities.data(), slowed.data());
    store(row, c);
  }
  schedule(inverse_masses, constraints);
  for (int pass = 0; pass < kVelocityPasses; ++pass) {
    double largest_sq = 0;
    relax_all(rows_, velocities.data(), slowed.data(), largest_sq);
    if (largest_sq < kVelocityTolerance * kVelocityTolerance) break;
  }
  for (const Row& row : rows_) store(row, constraints[row.constraint]);
}

}  // namespace weft::engine
