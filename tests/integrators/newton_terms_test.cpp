/// The potential of `newton`, by kernels in floats, against the list of terms in doubles.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/forces/every_term.h"
#include "weft/integrators/implicit_cloth.h"
#include "weft/integrators/newton_cloth.h"

namespace weft::engine {
namespace {

using test::largest;
using test::without_damping;

/// The largest forces on a particle by the terms; not of terms without any force [N].
struct Forces {
  double weakest = std::numeric_limits<double>::infinity(), strongest = 0;
};
Forces find_forces(const ClothModel& model, const ClothState& state, const Wind& wind) {
  const std::vector<Vec3> x = to_doubles(state.x), still(x.size(), Vec3::Zero());
  Forces forces;
  const auto include = [&](const Terms& terms, const std::vector<Vec3>& at) {
    for (const auto& term : terms) {
      std::vector<Vec3> own(x.size(), Vec3::Zero());
      term->add_force(at, own);
      if (largest(own) == 0) continue;
      forces.weakest = std::min(forces.weakest, largest(own));
      forces.strongest = std::max(forces.strongest, largest(own));
    }
  };
  include(make_elastic_terms(model, state), x);
  include(make_air_terms(model, state, wind, 0, {still, still, 1}), to_doubles(state.v));
  return forces;
}

/// In a step with wind and a moving pin, at x + h v.
struct Comparison {
  double force_error = 0;          // the largest of a particle [N]
  double change = 0, by_list = 0;  // of the energy, from the prediction [J]
  double energy = 0;               // [J]
};
Comparison compare(const ClothModel& model, const ClothState& state, const Wind& wind) {
  constexpr double kStep = 1.0 / 120;
  const auto jobs = make_serial_jobs();
  Environment environment{.time = kStep, .wind = wind};
  environment.pins = {{0, 5}, {state.position(0), state.position(5) + Vec3(0, 0.01, 0)}};
  ClothState in_floats = state, in_doubles = state;
  ImplicitCloth plain;
  plain.begin({&model, &environment, &in_doubles}, kStep, Order::first, Keeps::floats);
  plain.place_pins();
  NewtonCloth fast;
  fast.begin({&model, &environment, &in_floats}, {.step = kStep});
  fast.predict(true, *jobs);
  const PaddedRows rows = padded_rows_of(*model.topology);
  const auto place = [&] {
    std::vector<Vec3> x;
    const ContactTerms::Positions at = fast.positions();
    for (int i = 0; i < model.num_particles(); ++i)
      x.push_back(at.target->get(rows.index(i)) + at.offset->get(rows.index(i)));
    return x;
  };
  Comparison result{.change = -fast.energy(*jobs), .by_list = -sum_energies(plain.terms(), place())};
  fast.start_inertial(false);
  fast.accept_trial();
  result.energy = sum_energies(plain.terms(), place());
  result.change += fast.energy(*jobs);
  result.by_list += result.energy;
  std::vector<Vec3> error(model.num_particles(), Vec3::Zero());
  add_forces(plain.terms(), place(), error);
  for (const int p : environment.pins.particle) error[p].setZero();
  const Vec3Array& force = fast.find_forces(*jobs);
  for (int i = 0; i < model.num_particles(); ++i) error[i] -= force.get(rows.index(i));
  result.force_error = largest(error);
  return result;
}

TEST(NewtonTerms, HaveTheEnergiesAndForcesOfTheListInDoubles) {
  const Wind wind{.velocity = {3, 0, 1}, .drag = 0.2, .air = {.density = 1.2}};
  int num_telling = 0;
  for (const auto& [name, model, state] : test::make_crumpled_cloths()) {
    if (model->elements && !model->elements->hinges.empty()) continue;  // not in newton
    // The kernels' damping differs: it takes the whole change of strains and curvatures, the list's that to first
    // order, along the curvature.
    const auto undamped = without_damping(*model);
    const Comparison both = compare(*undamped, state, wind);
    const Forces forces = find_forces(*undamped, state, wind);
    const double error = 0.02 * forces.weakest + 5e-5 * forces.strongest;
    EXPECT_LT(both.force_error, error) << name;
    EXPECT_NEAR(both.change, both.by_list, 1e-5 * std::abs(both.energy)) << name;
    if (error < 0.5 * forces.weakest) ++num_telling;  // no force can be missing
  }
  EXPECT_GE(num_telling, 8);
}

/// Products are those of the assembled Hessian, of seams here; the part of rank one is that of no other term.
TEST(NewtonTerms, AsWrittenMultiplyByTheirHessian) {
  const auto jobs = make_serial_jobs();
  for (const auto& [name, model, state] : test::make_crumpled_cloths()) {
    const Terms written = make_terms_as_written(*model, state);
    const PaddedRows rows = padded_rows_of(*model->topology);
    const Environment environment;
    TermsAsWritten terms;
    terms.begin({*model, environment, state, rows});
    Vec3Array x(rows.size()), p(rows.size()), force(rows.size()), product(rows.size());
    Random random(4);
    for (int i = 0; i < model->num_particles(); ++i) {
      x.set(rows.index(i), state.x.get(i));
      p.set(rows.index(i), test::random_vector(random, 1));
    }
    terms.linearise({x, x}, *jobs, force);
    const double dot = terms.add_product(p, *jobs, product);
    std::vector<Vec3> expected(model->num_particles(), Vec3::Zero());
    double expected_dot = 0;
    for (const auto& term : written) {
      term->add_hessian(to_doubles(state.x), HessianKind::positive, [&](int i, int j, const Mat3& block) {
        expected[i] += block * p.get(rows.index(j));
        if (i != j) expected[j] += block.transpose() * p.get(rows.index(i));
      });
    }
    for (int i = 0; i < model->num_particles(); ++i) {
      EXPECT_LT((product.get(rows.index(i)) - expected[i]).norm(), 1e-5 * (1 + expected[i].norm())) << name;
      expected_dot += expected[i].dot(p.get(rows.index(i)));
    }
    EXPECT_NEAR(dot, expected_dot, 1e-9 * (1 + expected_dot)) << name;
    if (!model->topology->seams.springs.empty()) {
      EXPECT_GT(dot, 100) << name;
    }
  }
}

}  // namespace
}  // namespace weft::engine
