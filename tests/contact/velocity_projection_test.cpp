/// VelocityProjection against Gauss–Seidel in plain order: bit-identical.

#include "weft/contact/velocity_projection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support.h"

namespace weft::engine {
namespace {

struct Problem {
  std::vector<double> inverse_masses;
  std::vector<Constraint> constraints;
  std::vector<Vec3> velocities, slowed;
};

/// Constraints of one vertex, of triangles and of pairs, which share vertices; some are inactive, some
/// vertices are fixed.
Problem make_problem(double friction) {
  constexpr int kVertices = 40, kConstraints = 90;
  Random random(7);
  Problem problem;
  for (int v = 0; v < kVertices; ++v) {
    problem.inverse_masses.push_back(v % 9 == 0 ? 0.0 : random.uniform(500, 2000));
    problem.velocities.push_back(test::random_vector(random, 1));
  }
  problem.slowed.assign(kVertices, Vec3::Zero());
  constexpr int kSizes[] = {1, 3, 3, 4};
  for (int n = 0; n < kConstraints; ++n) {
    Constraint c;
    c.num_vertices = kSizes[n % 4];
    const int first = static_cast<int>(random.uniform(0, kVertices - 4));
    for (int k = 0; k < c.num_vertices; ++k) {
      c.vertex[k] = first + k;
      c.weight[k] = c.num_vertices == 1 ? 1.0 : random.uniform(0.1, 0.5);
    }
    if (c.num_vertices == 4) c.weight[3] = -1;
    c.normal = (Vec3::UnitY() + test::random_vector(random, 0.5)).normalized();
    c.surface_velocity = test::random_vector(random, 0.1);
    c.friction = n % 5 == 0 ? 0.0 : friction;
    c.is_active = n % 7 != 0;
    c.inverse_mass = c.inverse_mass_of(problem.inverse_masses);
    if (c.inverse_mass > 0) problem.constraints.push_back(c);
  }
  return problem;
}

void project_in_order(Problem& p) {
  constexpr int kPasses = 12;
  constexpr double kTolerance = 1e-4;
  for (int pass = 0; pass < kPasses; ++pass) {
    double largest_sq = 0;
    for (Constraint& c : p.constraints) {
      if (!c.is_active) continue;
      const double speed = c.normal.dot(c.sum(p.velocities) - c.surface_velocity);
      const double impulse = std::max(0.0, c.impulse - speed / c.inverse_mass);
      const double change = impulse - c.impulse;
      if (change != 0) {
        c.impulse = impulse;
        c.apply(change * c.normal, p.inverse_masses, p.velocities);
        largest_sq = std::max(largest_sq, change * change * (c.inverse_mass * c.inverse_mass));
      }
      const double most = c.friction * c.impulse;
      if (c.friction == 0 || (most == 0 && c.friction_impulse.isZero(0))) continue;
      const Vec3 relative = c.sum(p.velocities) - c.surface_velocity;
      const Vec3 slide = relative - relative.dot(c.normal) * c.normal;
      Vec3 friction = c.friction_impulse - slide / c.inverse_mass;
      const double length = friction.norm();
      if (length > most) friction *= most / length;
      const Vec3 more = friction - c.friction_impulse;
      c.friction_impulse = friction;
      c.apply(more, p.inverse_masses, p.velocities);
      c.apply(more, p.inverse_masses, p.slowed);
      largest_sq = std::max(largest_sq, more.squaredNorm() * (c.inverse_mass * c.inverse_mass));
    }
    if (largest_sq < kTolerance * kTolerance) break;
  }
}

TEST(VelocityProjection, HasTheBitsOfTheOrderGiven) {
  for (const double friction : {0.0, 0.3, 5.0}) {
    Problem expected = make_problem(friction), found = expected;
    project_in_order(expected);
    VelocityProjection projection;
    for (int repeat = 0; repeat < 2; ++repeat) {  // the second time with used work space
      found = make_problem(friction);
      std::vector<Quad> velocities, slowed(found.slowed.size());
      for (const Vec3& v : found.velocities) velocities.push_back(to_quad(v));
      projection.project(found.inverse_masses, found.constraints, velocities, slowed);
      for (std::size_t v = 0; v < velocities.size(); ++v) {
        EXPECT_EQ(velocities[v].to_vec3(), expected.velocities[v]) << friction;
        EXPECT_EQ(slowed[v].to_vec3(), expected.slowed[v]) << friction;
      }
      for (std::size_t n = 0; n < found.constraints.size(); ++n) {
        EXPECT_EQ(found.constraints[n].impulse, expected.constraints[n].impulse);
        EXPECT_EQ(found.constraints[n].friction_impulse, expected.constraints[n].friction_impulse);
      }
    }
  }
}

}  // namespace
}  // namespace weft::engine
