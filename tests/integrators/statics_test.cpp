/// Rest states of cloth against formulas.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

/// The largest error of a link's extension, relative to the largest extension, of a chain hung by its upper
/// end, at rest in still air. The step gives the paper's stiffness number `a`; 0: default.
double hanging_chain_error(std::string_view name, double a) {
  constexpr int kLinks = 20;
  constexpr double kMass = 0.01, kStiffness = 50, kLength = 0.05;
  std::vector<Vec3> places;
  for (int i = 0; i <= kLinks; ++i) places.push_back({0, -kLength * i, 0});
  const auto model = build_cloth_model(test::chain(places, kMass, kLength),
                                       {.density = 1, .structural = kStiffness, .damping = 0.5});
  ClothState state = make_state(places);
  Environment environment;
  environment.pins = {{0}, {places[0]}};
  environment.wind.drag = 5;
  double h = std::min(1.0 / 200, 0.5 * explicit_step_limit(*model, environment.wind));
  if (a > 0) h = std::sqrt(a / compute_stiffness_number(*model, 1));
  test::advance(*test::integrator(name), *model, environment, h, static_cast<int>(60 / h), state);
  double error = 0;
  for (int i = 1; i <= kLinks; ++i) {
    const double extension = (state.position(i) - state.position(i - 1)).norm() - kLength;
    error = std::max(error, std::abs(extension - (kLinks - i + 1) * kMass * 9.81 / kStiffness));
  }
  return error / (kLinks * kMass * 9.81 / kStiffness);
}

TEST(HangingChain, StretchesByTheWeightBelow) {
  for (const char* name : {"explicit", "desbrun", "implicit_euler", "newton"}) {
    EXPECT_LT(hanging_chain_error(name, 0), 3e-4) << name;
  }
}

TEST(HangingChain, OfThePapersFilterIsRightOnlyForSmallStiffnessNumbers) {
  // Known limits. The fixed filter passes gravity and weakens springs by 1 − a²: statics deviate by that
  // share. The printed one assumes that the pinned neighbour yields, so that the uppermost link deviates by
  // about a.
  for (const char* name : {"paper", "paper_fixed"}) {
    EXPECT_LT(hanging_chain_error(name, 0.01), 0.02) << name;
    EXPECT_GT(hanging_chain_error(name, 0.5), 0.05) << name;
  }
}

TEST(HangingChain, OfXpbdIsRightOnlyInSmallSteps) {
  // A known limit. Each spring includes the gravity response of the springs before it in the pass, but not of
  // those after it: the error is about 2 h b/m from damping (h²k/m without it) and goes to zero with h.
  const double coarse = hanging_chain_error("xpbd", 1e-2), fine = hanging_chain_error("xpbd", 1e-4);
  EXPECT_LT(fine, 0.01);
  EXPECT_NEAR(coarse / fine, 10, 2) << "with a tenth of the step";
}

/// Sag over span of a chain of `links` hung between two supports, its length `ratio` times their distance.
double catenary_sag(double ratio, int links) {
  const double link = ratio / links;
  std::vector<Vec3> places;  // a shallow V, nearly the right length
  for (int i = 0; i <= links; ++i) {
    const double s = static_cast<double>(i) / links;
    places.push_back({s, -std::min(s, 1 - s) * std::sqrt(ratio * ratio - 1), 0});
  }
  const auto model = build_cloth_model(test::chain(places, 0.001, link), {.density = 1, .structural = 1e6});
  ClothState state = make_state(places);
  Environment environment;
  environment.pins = {{0, links}, {places.front(), places.back()}};
  environment.wind.drag = 10;
  test::advance(*make_implicit_euler({.tolerance = 1e-5}), *model, environment, 0.05, 400, state);
  return -compute_lowest_y(state);
}

TEST(Catenary, SagsAsTheFormulaSays) {
  // The discretisation error of the chain falls with the square of the link length: at 60 links about 2e-4.
  EXPECT_NEAR(catenary_sag(1.05, 60), 0.139304, 4e-4);
  EXPECT_NEAR(catenary_sag(1.25, 60), 0.331797, 4e-4);
  EXPECT_NEAR(catenary_sag(2.0, 60), 0.796388, 6e-4);
}

TEST(FlatSheet, StaysExactlyAtRestWithoutGravity) {
  for (const std::string_view name : integrator_names()) {
    for (const SpringModel spring_model :
         {SpringModel::basic, SpringModel::simplified, SpringModel::alternating}) {
      // Power-of-two spacing, so that rest lengths along rows and columns are exact in floats; no diagonals,
      // because their rest length √2/16 is not representable.
      const auto topology = build_grid_topology(test::square(16), spring_model);
      const auto model =
          build_cloth_model(topology, {.structural = 100, .shear = 0, .bend = 1, .damping = 0.001});
      ClothState state = make_state(topology->mesh.positions);
      const ClothState start = state;
      test::advance(*test::integrator(name), *model, {.gravity = Vec3::Zero()}, 1e-3, 20, state);
      for (int i = 0; i < model->num_particles(); ++i) {
        EXPECT_EQ(state.position(i), start.position(i)) << name;
        EXPECT_EQ(state.v.get(i), Vec3::Zero()) << name;
      }
    }
  }
}

/// A sheet hung by two corners, after `seconds` of slow settling: the distance of its lowest particle from
/// the middle.
double skewness(SpringModel spring_model) {
  const auto topology = build_grid_topology(test::square(16), spring_model);
  const double shear = spring_model == SpringModel::basic ? 50 : 100;
  const auto model =
      build_cloth_model(topology, {.structural = 100, .shear = shear, .bend = 1, .damping = 0.001});
  ClothState state = make_state(topology->mesh.positions);
  Environment environment;
  environment.pins = {{0, 16}, {state.position(0), state.position(16)}};
  test::advance(*test::integrator("desbrun"), *model, environment, 1.0 / 120, 60, state);
  double left_right = 0;
  for (int j = 0; j <= 16; ++j) {
    for (int i = 0; i <= 16; ++i) {
      const Vec3 a = state.position(topology->grid->index(i, j)),
                 b = state.position(topology->grid->index(16 - i, j));
      left_right = std::max(left_right,
                            std::abs(a.x() + b.x() - 1) + std::abs(a.y() - b.y()) + std::abs(a.z() - b.z()));
    }
  }
  return left_right;
}

TEST(SpringModels, SimplifiedHangsAskewAndAlternatingDoesNot) {
  EXPECT_LT(skewness(SpringModel::basic), 1e-5);
  EXPECT_LT(skewness(SpringModel::alternating), 1e-5);
  EXPECT_GT(skewness(SpringModel::simplified), 0.01) << "the paper's model: a finding";
}

}  // namespace
}  // namespace weft::engine
