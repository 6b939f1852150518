/// Every term of the list: forces, Hessians and pairs against finite differences of energies and forces.

#include "weft/forces/terms.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <set>

#include "tests/forces/every_term.h"
#include "tests/read_text.h"

namespace weft::engine {
namespace {

using Positions = Term::Positions;

std::vector<Vec3> random_direction(std::size_t size, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> direction;
  for (std::size_t i = 0; i < size; ++i) direction.push_back(test::random_vector(random, 1));
  return direction;
}

Positions moved(const Positions& x, const std::vector<Vec3>& direction, double share) {
  Positions to = x;
  for (std::size_t i = 0; i < x.size(); ++i) to[i] += share * direction[i];
  return to;
}

double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

std::vector<Vec3> force_of(const Term& term, const Positions& x) {
  std::vector<Vec3> force(x.size(), Vec3::Zero());
  term.add_force(x, force);
  return force;
}

/// The Hessian with the part of rank one (3 num_particles)². Its pairs must be listed.
Eigen::MatrixXd dense(const Term& term, const Positions& x, HessianKind kind) {
  std::set<std::pair<int, int>> listed;
  term.list_pairs([&](int i, int j) { listed.insert(std::minmax(i, j)); });
  const auto size = static_cast<Eigen::Index>(3 * x.size());
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(size, size);
  term.add_hessian(x, kind, [&](int i, int j, const Mat3& block) {
    hessian.block<3, 3>(3 * i, 3 * j) += block;
    if (i == j) return;
    hessian.block<3, 3>(3 * j, 3 * i) += block.transpose();
    EXPECT_TRUE(listed.contains(std::minmax(i, j))) << i << ' ' << j;
  });
  if (const auto rank_one = term.rank_one(x)) {
    const Eigen::Map<const Eigen::VectorXd> gradient(rank_one->gradient[0].data(), size);
    hessian += rank_one->stiffness * gradient * gradient.transpose();
  }
  return hessian;
}

void expect_consistent(const std::string& name, const Term& term, const Positions& x) {
  constexpr double kStep = 1e-6;
  const std::vector<Vec3> direction = random_direction(x.size(), 3);
  const Positions more = moved(x, direction, kStep), less = moved(x, direction, -kStep);
  const double slope = (term.energy(more) - term.energy(less)) / (2 * kStep),
               expected = -dot(force_of(term, x), direction);
  EXPECT_NEAR(slope, expected, 1e-6 * std::abs(expected) + 1e-7) << name;
  const auto size = static_cast<Eigen::Index>(3 * x.size());
  const auto flat = [&](const std::vector<Vec3>& values) {
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values[0].data(), size));
  };
  if (term.has_exact_hessian()) {
    const Eigen::VectorXd exact = dense(term, x, HessianKind::exact) * flat(direction),
                          change = (flat(force_of(term, less)) - flat(force_of(term, more))) / (2 * kStep);
    EXPECT_LT((exact - change).norm(), 1e-4 * exact.norm() + 1e-6) << name;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> values(dense(term, x, HessianKind::positive),
                                                              Eigen::EigenvaluesOnly);
  EXPECT_GE(values.eigenvalues()[0], -1e-9 * values.eigenvalues()[size - 1]) << name;
}

TEST(Terms, OfTheListAreDerivativesOfTheirEnergies) {
  std::set<std::string> seen;
  for (const auto& [name, model, state] : test::make_crumpled_cloths()) {
    for (const ElasticRow& row : elastic_rows()) {
      const auto term = row.make(*model, state);
      if (!term) continue;
      // Away from the state: threads that slip are exactly at the end of sticking there.
      const Positions x = moved(to_doubles(state.x), random_direction(state.x.size(), 2), 0.003);
      if (term->energy(x) != 0) seen.insert(row.name);
      expect_consistent(name + ": " + row.name, *term, x);
      Vec3 sum = Vec3::Zero();
      for (const Vec3& f : force_of(*term, x)) sum += f;
      EXPECT_LT(sum.norm(), 1e-9) << name << ": " << row.name << ": elastic forces sum to zero";
    }
  }
  for (const ElasticRow& row : elastic_rows()) EXPECT_TRUE(seen.contains(row.name)) << row.name;
}

TEST(Terms, OfDampingAndAirAreDerivativesOfTheirEnergiesAndOnlyBrake) {
  const Wind wind{.velocity = {3, 0, 1}, .drag = 0.2, .air = {.density = 1.2}};
  for (const auto& [name, model, state] : test::make_crumpled_cloths()) {
    const Positions start = to_doubles(state.x), x = moved(start, to_doubles(state.v), 0.01),
                    shape = moved(start, random_direction(start.size(), 5), 0.002);
    const Motion motion{start, shape, 0.01};
    const Terms damping = make_damping_terms(*model, motion);
    EXPECT_FALSE(damping.empty()) << name;
    for (const auto& term : damping) {
      expect_consistent(name + ": damping", *term, x);
      EXPECT_LT(dot(force_of(*term, x), to_doubles(state.v)), 0) << name;
    }
    const Terms air = make_air_terms(*model, state, wind, 0, motion);
    EXPECT_EQ(air.size(), 2u);
    for (const auto& term : air) expect_consistent(name + ": air", *term, x);
  }
}

TEST(Terms, AreThoseOfTheTableInTheManual) {
  const std::string page = read_text(WEFT_SOURCE_DIR "/docs/explanation/method.md");
  for (const ElasticRow& row : elastic_rows()) {
    const std::string in_newton = row.in_newton == InNewton::by_kernel ? "kernel |" : "as written |";
    const std::size_t begin = page.find("\n| " + std::string(row.name) + " |");
    ASSERT_NE(begin, std::string::npos) << row.name;
    const std::string line = page.substr(begin + 1, page.find('\n', begin + 1) - begin - 1);
    EXPECT_TRUE(line.ends_with(in_newton)) << line;
  }
}

}  // namespace
}  // namespace weft::engine
