/// The default integrator: accuracy and robustness.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support.h"
#include "weft/core/hash.h"
#include "weft/core/simd.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

using test::Hung;
using test::rms_distance;
using test::square;

std::unique_ptr<Integrator> newton(int iterations = 0) { return make_newton({.iterations = iterations}); }

double largest_strain(const ClothModel& model, const ClothState& state) {
  return compute_strain(model, state).max;
}

TEST(Newton, FollowsTheHangingSheetOfRealFabric) {
  constexpr int kCells = 31, kFrames = 60;
  for (const auto& topology :
       {build_grid_topology(square(kCells), SpringModel::simplified),
        build_grid_topology(square(kCells), SpringModel::alternating),
        build_grid_topology(square(kCells), SpringModel::basic), test::mesh_of(square(kCells))}) {
    Hung reference(topology, kCells), fast(topology, kCells);
    const auto exact = test::integrator("explicit");
    const auto integrator = newton();
    const double limit = explicit_step_limit(*reference.model, {});
    const int substeps = static_cast<int>(std::ceil(1.0 / 60 / (0.25 * limit)));
    double error = 0, worst = 0, worst_reference = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
      test::advance(*exact, *reference.model, reference.environment, 1.0 / 60 / substeps, substeps,
                    reference.state);
      test::advance(*integrator, *fast.model, fast.environment, 1.0 / 60, 1, fast.state);
      error += rms_distance(fast.state, reference.state) / kFrames;
      worst = std::max(worst, largest_strain(*fast.model, fast.state));
      worst_reference = std::max(worst_reference, largest_strain(*reference.model, reference.state));
    }
    RecordProperty("error_mm", std::to_string(1000 * error));
    EXPECT_LT(error, 0.05);  // measured 0.04, for a swing of a metre
    EXPECT_GT(worst, 0.6 * worst_reference);
    EXPECT_LT(worst, 1.4 * worst_reference);
  }
}

TEST(Newton, StaysTameAtEveryIterationCount) {
  // With the transverse stiffness of compressed springs clamped at zero, strains would reach hundreds of
  // percent, increasing with the iterations.
  for (const int iterations : {5, 10, 20, 40, 100, 200}) {
    Hung sheet(build_grid_topology(square(31), SpringModel::simplified), 31);
    const auto integrator = newton(iterations);
    for (int frame = 0; frame < 60; ++frame) {
      test::advance(*integrator, *sheet.model, sheet.environment, 1.0 / 60, 1, sheet.state);
      ASSERT_LT(largest_strain(*sheet.model, sheet.state), 0.1) << iterations << ", frame " << frame;
    }
  }
}

/// A soft sheet after half a second in n equal steps, or (ratio not 1) in pairs of steps with that ratio.
ClothState swing(int steps, double ratio) {
  Hung sheet(build_grid_topology(square(6), SpringModel::simplified), 6,
             {.structural = 20, .shear = 10, .bend = 1, .damping = 0.01});
  const auto integrator = newton(60);
  const double h = 0.5 / steps;
  for (int s = 0; s < steps; ++s) {
    const double step = s % 2 == 0 ? 2 * h * ratio / (1 + ratio) : 2 * h / (1 + ratio);
    test::advance(*integrator, *sheet.model, sheet.environment, step, 1, sheet.state);
  }
  return sheet.state;
}

TEST(Newton, IsOfSecondOrder) {
  for (const double ratio : {1.0, 1.5}) {
    const ClothState coarse = swing(60, ratio), middle = swing(120, ratio), fine = swing(240, ratio);
    // Halving the step divides the difference by 4 if the order is 2, by 2 if it is 1.
    const double order = std::log2(rms_distance(coarse, middle) / rms_distance(middle, fine));
    EXPECT_GT(order, 1.7) << "steps of ratio " << ratio;
    EXPECT_LT(order, 2.4) << "steps of ratio " << ratio;
  }
}

TEST(Newton, ComesToTheRestOfImplicitEuler) {
  for (const auto& topology :
       {build_grid_topology(square(10), SpringModel::alternating), test::mesh_of(square(10))}) {
    // Pinned along its whole first row: pinned at two corners it has several rest states.
    Hung a(topology, 10), b(topology, 10);
    for (Hung* sheet : {&a, &b}) {
      sheet->environment.wind.drag = 1;
      sheet->environment.pins = {};
      for (int i = 0; i <= 10; ++i) {
        sheet->environment.pins.particle.push_back(i);
        sheet->environment.pins.position.push_back(sheet->state.position(i));
      }
    }
    test::advance(*newton(), *a.model, a.environment, 1.0 / 60, 1200, a.state);
    test::advance(*make_implicit_euler({.tolerance = 1e-6}), *b.model, b.environment, 1.0 / 60, 600, b.state);
    EXPECT_LT(rms_distance(a.state, b.state), 1e-3) << "of a metre; sideways little holds it";
  }
}

TEST(Newton, KeepsMomentumWithFewAndManyIterationsHereAndTenKilometresAway) {
  for (const int iterations : {1, 5, 10}) {
    for (const Vec3& place : {Vec3(0, 0, 0), Vec3(10000, 300, -10000)}) {
      for (const auto& topology :
           {build_grid_topology(square(16), SpringModel::simplified), test::mesh_of(square(16))}) {
        std::vector<Vec3> positions;
        for (const Vec3& p : topology->mesh.positions) positions.push_back(p + place);
        const auto model = build_cloth_model(topology, {});
        ClothState state = make_state(positions);
        test::shake(state, 0.002, 0.5);
        const Vec3 before = compute_momentum(*model, state);
        test::advance(*newton(iterations), *model, {.gravity = Vec3::Zero()}, 1.0 / 60, 60, state);
        // Sixty roundings of some 289 speeds of a few m/s, of 0.2 kg in all.
        EXPECT_LT((compute_momentum(*model, state) - before).norm(), 3e-6) << iterations;
      }
    }
  }
}

TEST(Newton, OfDisconnectedAndLightPiecesEachKeepsItsOwnMomentum) {
  // Two squares and a single triangle that is a millionth as heavy; one of the squares is pinned.
  TriangleMesh mesh;
  const auto add_square = [&](double x) {
    const int first = mesh.num_vertices();
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0.1, 0, 0), Vec3(0, 0, 0.1), Vec3(0.1, 0, 0.1)})
      mesh.positions.push_back(p + Vec3(x, 0, 0));
    mesh.triangles.push_back({first, first + 2, first + 1});
    mesh.triangles.push_back({first + 1, first + 2, first + 3});
  };
  add_square(0);
  add_square(1);
  for (const Vec3& p : {Vec3(2, 0, 0), Vec3(2.0001, 0, 0), Vec3(2, 0, 0.0001)}) mesh.positions.push_back(p);
  mesh.triangles.push_back({8, 10, 9});
  const auto topology = build_mesh_topology(mesh);
  const auto model = build_cloth_model(topology, {});
  ClothState state = make_state(topology->mesh.positions);
  Environment environment;
  environment.pins = {{0}, {state.position(0)}};
  constexpr int kSteps = 30;
  test::advance(*newton(3), *model, environment, 1.0 / 60, kSteps, state);
  for (const int i : {4, 5, 6, 7, 8, 9, 10}) {
    EXPECT_NEAR(state.v.get(i).y(), -9.81 * kSteps / 60, 1e-4) << i;
    EXPECT_NEAR(state.position(i).y(), -0.5 * 9.81 * kSteps * kSteps / 3600, 1e-5) << i;
  }
  EXPECT_LT((state.position(3) - state.position(0)).norm(), 0.15) << "the pinned square hangs";
}

std::uint64_t hash_after(const std::shared_ptr<const ClothTopology>& topology, int cells, int threads) {
  Hung sheet(topology, cells, {.damping = 1e-3});
  const auto jobs = make_jobs(threads);
  const auto integrator = newton();
  for (int s = 0; s < 3; ++s)
    integrator->advance(*sheet.model, sheet.environment, 1.0 / 60, *jobs, sheet.state);
  Hash hash;
  add_to_hash(sheet.state, hash);
  return hash.value();
}

TEST(Newton, HasTheSameBitsForAnyNumberOfThreadsAndEveryVectorWidth) {
  for (const SpringModel spring_model :
       {SpringModel::simplified, SpringModel::basic, SpringModel::alternating}) {
    const auto topology = build_grid_topology(square(101), spring_model);
    const std::uint64_t hash = hash_after(topology, 101, 1);
    EXPECT_EQ(hash, hash_after(topology, 101, 2));
    for (const SimdLevel level : {SimdLevel::baseline, SimdLevel::avx2}) {
      limit_simd_level(level);
      EXPECT_EQ(hash, hash_after(topology, 101, 1)) << to_string(level);
      limit_simd_level(best_simd_level());
    }
  }
}

TEST(Newton, HasTheSameBitsOnMeshesToo) {
  const auto mesh = test::mesh_of(square(101));
  const std::uint64_t hash = hash_after(mesh, 101, 1);
  EXPECT_EQ(hash, hash_after(mesh, 101, 3));
  limit_simd_level(SimdLevel::baseline);
  EXPECT_EQ(hash, hash_after(mesh, 101, 1));
  limit_simd_level(best_simd_level());
}

TEST(Newton, StaysSettledThroughARestart) {
  Hung sheet(build_grid_topology(square(16), SpringModel::simplified), 16);
  sheet.environment.wind.drag = 1;
  const auto integrator = newton();
  test::advance(*integrator, *sheet.model, sheet.environment, 1.0 / 60, 900, sheet.state);
  const ClothState settled = sheet.state;

  ClothState copy = settled, another = settled;
  test::advance(*integrator, *sheet.model, sheet.environment, 1.0 / 60, 5, copy);
  test::advance(*newton(), *sheet.model, sheet.environment, 1.0 / 60, 5, another);
  EXPECT_EQ(rms_distance(copy, another), 0) << "all that is remembered is in the state";
  EXPECT_LT(rms_distance(copy, settled), 1e-5);

  // Without history: the initial history includes that the pins carry the whole weight.
  ClothState forgetful = settled;
  forgetful.history = {};
  test::advance(*newton(), *sheet.model, sheet.environment, 1.0 / 60, 5, forgetful);
  EXPECT_LT(rms_distance(forgetful, settled), 1e-4);
}

TEST(Newton, TellsWhatItDid) {
  Hung sheet(build_grid_topology(square(8), SpringModel::simplified), 8);
  const auto jobs = make_serial_jobs();
  const IntegratorReport report =
      newton(7)->advance(*sheet.model, sheet.environment, 1.0 / 60, *jobs, sheet.state);
  EXPECT_EQ(report.iterations, 1);
  EXPECT_EQ(report.linear_iterations, 7);
  EXPECT_EQ(report.guard_events, 0);
}

TEST(Newton, TellsItsResidual) {
  const auto jobs = make_serial_jobs();
  const auto residual = [&](int iterations) {
    Hung sheet(build_grid_topology(square(8), SpringModel::simplified), 8);
    return *newton(iterations)
                ->advance(*sheet.model, sheet.environment, 1.0 / 60, *jobs, sheet.state)
                .residual;
  };
  EXPECT_DOUBLE_EQ(residual(1), 1) << "before the first iteration it is the right side";
  EXPECT_LT(residual(4), 0.3);
  EXPECT_LT(residual(20), 0.01);
  EXPECT_GT(residual(20), 0);
}

TEST(Newton, WorksHarderTheStifferTheClothIsAndTheLongerTheStep) {
  const auto jobs = make_serial_jobs();
  const auto iterations = [&](double stiffness, double step, NewtonQuality quality) {
    Hung sheet(build_grid_topology(square(20), SpringModel::simplified), 20,
               {.structural = stiffness, .shear = stiffness / 2, .bend = stiffness / 100});
    constexpr int kSteps = 30;
    const auto integrator = make_newton({.quality = quality});
    int sum = 0;
    for (int s = 0; s < kSteps; ++s) {
      sum +=
          *integrator->advance(*sheet.model, sheet.environment, step, *jobs, sheet.state).linear_iterations;
    }
    return sum / kSteps;
  };
  constexpr NewtonQuality kNormal = NewtonQuality::normal;
  const int usual = iterations(2000, 1.0 / 60, kNormal);
  EXPECT_NEAR(usual, 11, 3);
  EXPECT_LT(iterations(200, 1.0 / 60, kNormal), usual);
  EXPECT_GT(iterations(20000, 1.0 / 60, kNormal), 1.5 * usual) << "and in two Newton steps";
  EXPECT_LT(iterations(2000, 1.0 / 60, NewtonQuality::fast), usual);
  EXPECT_GT(iterations(2000, 1.0 / 60, NewtonQuality::high), 2 * usual);
}

/// Period of a stiff pendulum released at the given angle, from its first two downward passages.
double pendulum_period(double angle) {
  const std::vector<Vec3> places = {Vec3::Zero(), {std::sin(angle), -std::cos(angle), 0}};
  const auto model = build_cloth_model(test::chain(places, 0.1, 1), {.density = 1, .structural = 1e5});
  ClothState state = make_state(places);
  Environment environment;
  environment.pins = {{0}, {Vec3::Zero()}};
  const auto integrator = newton(10);
  const double h = 1.0 / 240;
  double before = places[1].x(), first = 0, last = 0;
  int passages = 0;
  for (int s = 1; passages < 5 && s < 10000; ++s) {
    test::advance(*integrator, *model, environment, h, 1, state);
    const double now = state.position(1).x();
    if (before * now < 0) {
      last = h * (s - now / (now - before));
      if (++passages == 1) first = last;
    }
    before = now;
  }
  return (last - first) / 2;
}

TEST(Newton, HasThePeriodsOfThePendulum) {
  const double small = 2 * 3.14159265358979 / std::sqrt(9.81);
  for (const auto& [degrees, ratio] : {std::pair{30.0, 1.017409}, {60.0, 1.073182}, {90.0, 1.180341}}) {
    const double period = pendulum_period(degrees * 3.14159265358979 / 180);
    EXPECT_NEAR(period / small, ratio, 0.01 * ratio) << degrees << " degrees";
  }
}

/// Frequency of a hanging strip in its n-th mode, from the zero crossings of its tip [Hz].
double strip_frequency(double bessel_zero) {
  constexpr int kLinks = 100;
  constexpr double kStep = 1.0 / 240, kAmplitude = 2e-3;
  constexpr double kMass = 1e-3, kStiffness = 1e5;
  std::vector<Vec3> places;
  double y = 0;
  for (int i = 0; i <= kLinks; ++i) {
    const double s = 1 - static_cast<double>(i) / kLinks;  // height over the free end
    places.push_back({kAmplitude * std::cyl_bessel_j(0.0, bessel_zero * std::sqrt(s)), y, 0});
    y -= 1.0 / kLinks + (kLinks - i) * kMass * 9.81 / kStiffness;  // hanging at rest
  }
  const auto model =
      build_cloth_model(test::chain(places, kMass, 1.0 / kLinks), {.density = 1, .structural = kStiffness});
  ClothState state = make_state(places);
  Environment environment;
  environment.pins = {{0}, {places[0]}};
  const auto integrator = newton(60);
  double before = state.position(kLinks).x(), first = 0, last = 0;
  int crossings = 0;
  for (int s = 1; s < 240 * 4; ++s) {
    test::advance(*integrator, *model, environment, kStep, 1, state);
    const double now = state.position(kLinks).x();
    if (before * now < 0) {
      last = kStep * (s - now / (now - before));
      if (++crossings == 1) first = last;
    }
    before = now;
  }
  return 0.5 * (crossings - 1) / (last - first);
}

TEST(Newton, SwingsAHangingStripAtItsFrequencies) {
  // (j/4π) √(g/L) with the zeros of the Bessel function J0. A chain of 100 links, with full mass at the last,
  // is half a link too long: 0.25 %.
  for (const double zero : {2.404826, 5.520078, 8.653728}) {
    const double expected = zero / (4 * 3.14159265358979) * std::sqrt(9.81);
    EXPECT_NEAR(strip_frequency(zero), expected, 0.01 * expected);
  }
}

}  // namespace
}  // namespace weft::engine
