/// Strain limit inside the solve: it holds on every mesh, hung, swung and pulled, and does not change other
/// motion.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/integrators/fabric_sheets.h"
#include "tests/support.h"
#include "weft/fabric.h"
#include "weft/forces/membrane.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

using test::hung_by;
using test::on_grid;
using test::on_mesh;
using test::springs_on;
using test::square;

/// A soft jersey: without a limit it stretches by a third under its own weight.
Fabric soft(double strain_limit) {
  Fabric fabric = find_fabric("gray_interlock");
  fabric.strain_limit = strain_limit;
  return fabric;
}

/// The largest principal stretch less one.
double worst(const ClothModel& model, const ClothState& state) {
  double most = 0;
  for (const auto& [v, rest] : model.elements->membranes) {
    const auto at = [&](int c) { return state.position(v[c]); };
    most = std::max(most, principal_stretches(rest, {at(0), at(1), at(2)})[1] - 1);
  }
  return most;
}

std::vector<std::shared_ptr<const ClothModel>> sheets(int cells, const Fabric& fabric) {
  return {on_grid(square(cells), fabric), on_mesh(square(cells), fabric)};
}

/// Calls `look` after every frame of a sheet released from the horizontal, pinned at two corners.
template <class Look>
void swing(const ClothModel& model, Integrator& integrator, int cells, int frames, const Look& look) {
  ClothState state = make_state(model.topology->mesh.positions);
  const Environment environment = hung_by(model, {0, cells});
  for (int frame = 0; frame < frames; ++frame) {
    test::advance(integrator, model, environment, 1.0 / 60, 1, state);
    look(state);
  }
}

constexpr double kLimit = 0.01, kMaxStrain = 0.015;

TEST(StrainLimit, HoldsWhileClothSwingsFromTwoCornersOnEveryMesh) {
  for (const int cells : {10, 20, 40}) {
    for (const auto& model : sheets(cells, soft(kLimit))) {
      if (cells == 40 && !model->topology->grid) continue;
      double most = 0;
      swing(*model, *make_newton({}), cells, 60,
            [&](const ClothState& state) { most = std::max(most, worst(*model, state)); });
      EXPECT_LT(most, kMaxStrain) << cells;
      EXPECT_GT(most, 0.9 * kLimit) << "it does give in to as much";
    }
  }
  double free = 0;
  const auto model = on_grid(square(20), soft(0));
  swing(*model, *make_newton({}), 20, 60,
        [&](const ClothState& state) { free = std::max(free, worst(*model, state)); });
  EXPECT_GT(free, 0.3) << "what the limit holds back";
}

TEST(StrainLimit, HoldsForSpringsThatAreTheMembranes) {
  for (const int cells : {10, 20, 40}) {
    const auto model = springs_on(square(cells), kLimit);
    double most = 0;
    swing(*model, *make_newton({}), cells, 60,
          [&](const ClothState& state) { most = std::max(most, compute_strain(*model, state).max); });
    EXPECT_LT(most, kMaxStrain) << cells;
    EXPECT_GT(most, 0.9 * kLimit) << "it does give in to as much";
  }
  const auto limited = springs_on(square(12), kLimit), free = springs_on(square(12), 0);
  double with = 0, without = 0;
  swing(*limited, *make_implicit_euler({}), 12, 45,
        [&](const ClothState& state) { with = std::max(with, compute_strain(*limited, state).max); });
  swing(*free, *make_newton({}), 12, 45,
        [&](const ClothState& state) { without = std::max(without, compute_strain(*free, state).max); });
  EXPECT_LT(with, kMaxStrain) << "implicit_euler";
  EXPECT_GT(without, 0.05) << "what the limit holds back";
}

TEST(StrainLimit, OfSpringsIsTheSameInFloatsAndInDoubles) {
  const auto model = springs_on(square(10), kLimit);
  ClothState fast = make_state(model->topology->mesh.positions), exact = fast;
  const Environment environment = hung_by(*model, {0, 10});
  const auto in_doubles = make_integrator({.integrator = "newton", .is_double = true});
  const auto in_floats = make_newton({.quality = NewtonQuality::high});
  for (int frame = 0; frame < 20; ++frame) {
    test::advance(*in_floats, *model, environment, 1.0 / 240, 4, fast);
    test::advance(*in_doubles, *model, environment, 1.0 / 240, 4, exact);
  }
  EXPECT_LT(test::rms_distance(fast, exact), 2e-3);
}

TEST(StrainLimit, HoldsWithImplicitEuler) {
  for (const auto& model : sheets(12, soft(kLimit))) {
    double most = 0;
    swing(*model, *make_implicit_euler({}), 12, 45,
          [&](const ClothState& state) { most = std::max(most, worst(*model, state)); });
    EXPECT_LT(most, kMaxStrain);
  }
}

TEST(StrainLimit, HoldsWhileACornerIsPulledAboutByAHand) {
  // Back and forth by 30 cm twice a second: up to 3.8 m/s.
  for (const auto& model : sheets(20, soft(kLimit))) {
    ClothState state = make_state(model->topology->mesh.positions);
    Environment environment = hung_by(*model, {0});
    const auto integrator = make_newton({});
    for (int frame = 1; frame <= 60; ++frame) {
      environment.pins.position[0] = 0.3 * std::sin(4 * 3.14159265 * frame / 60) * Vec3(1, 0.5, 0);
      test::advance(*integrator, *model, environment, 1.0 / 60, 1, state);
      ASSERT_LT(worst(*model, state), kMaxStrain) << "frame " << frame;
    }
  }
}

/// Energy of the differences between neighbours: the shortest waves.
double roughness(const ClothModel& model, const ClothState& state) {
  double sum = 0;
  for (const Spring& s : model.topology->springs) {
    if (s.kind == SpringKind::structural)
      sum += 0.5 * model.mass[s.i] * (state.v.get(s.i) - state.v.get(s.j)).squaredNorm();
  }
  return sum;
}

TEST(StrainLimit, MovesAsStiffClothAndNoRougher) {
  // Both hardly stretch, so both must swing alike: the limit causes neither drag nor oscillation.
  constexpr int kCells = 20;
  Fabric stiff = soft(0);
  for (double* c : {&stiff.c11, &stiff.c22, &stiff.c12, &stiff.g}) *c *= 100;
  const auto limited_model = on_grid(square(kCells), soft(kLimit)),
             stiff_model = on_grid(square(kCells), stiff);
  std::vector<double> lowest;
  double rough = 0, distance = 0;
  swing(*stiff_model, *make_newton({}), kCells, 90, [&](const ClothState& state) {
    lowest.push_back(compute_lowest_y(state));
    rough += roughness(*stiff_model, state);
  });
  double limited_rough = 0;
  std::size_t frame = 0;
  swing(*limited_model, *make_newton({}), kCells, 90, [&](const ClothState& state) {
    distance += std::abs(compute_lowest_y(state) - lowest[frame++]) / 90;
    limited_rough += roughness(*limited_model, state);
  });
  EXPECT_LT(distance, 0.08) << "0.05 of a swing of more than a metre; in shear it gives in up to the limit";
  EXPECT_LT(limited_rough, 1.5 * rough);
}

}  // namespace
}  // namespace weft::engine
