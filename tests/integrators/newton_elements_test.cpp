/// Membrane and bending elements in newton: against explicit integration, implicit_euler and formulas.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/integrators/fabric_sheets.h"
#include "tests/support.h"
#include "weft/core/hash.h"
#include "weft/core/simd.h"
#include "weft/fabric.h"
#include "weft/forces/terms.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

using test::hung_by;
using test::on_grid;
using test::on_mesh;
using test::square;

double rms_distance(const std::vector<Vec3>& a, const ClothState& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b.position(i)).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

/// Symplectic Euler in double precision, without damping.
class Explicit {
 public:
  explicit Explicit(const ClothModel& model)
      : model_(model),
        terms_(make_elastic_terms(model, make_state(model.topology->mesh.positions))),
        x(model.topology->mesh.positions),
        v_(x.size(), Vec3::Zero()) {}

  void advance(const Environment& environment, double step, int num_steps) {
    for (int s = 0; s < num_steps; ++s) {
      force_.assign(x.size(), Vec3::Zero());
      add_forces(terms_, x, force_);
      for (const int p : environment.pins.particle) force_[p] = -model_.mass[p] * environment.gravity;
      for (std::size_t i = 0; i < x.size(); ++i) {
        v_[i] += step * (environment.gravity + force_[i] / model_.mass[i]);
        x[i] += step * v_[i];
      }
    }
  }

 private:
  const ClothModel& model_;
  Terms terms_;

 public:
  std::vector<Vec3> x;

 private:
  std::vector<Vec3> v_, force_;
};

TEST(NewtonElements, FollowTheHangingSheetOfRealFabric) {
  constexpr int kCells = 16, kFrames = 60, kSubsteps = 200;
  Fabric denim = find_fabric("denim");
  denim.damping = denim.bend_hysteresis_warp = denim.bend_hysteresis_weft = 0;
  for (const auto& model : {on_grid(square(kCells), denim), on_mesh(square(kCells), denim)}) {
    const Environment environment = hung_by(*model, {0, kCells});
    Explicit reference(*model);
    ClothState state = make_state(model->topology->mesh.positions);
    const auto integrator = make_newton({});
    double error = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
      reference.advance(environment, 1.0 / 60 / kSubsteps, kSubsteps);
      test::advance(*integrator, *model, environment, 1.0 / 60, 1, state);
      error += rms_distance(reference.x, state) / kFrames;
    }
    RecordProperty("error_mm", std::to_string(1000 * error));
    EXPECT_LT(error, 0.045) << "0.03 to 0.04 as measured, of a swing of a metre";
  }
}

TEST(NewtonElements, StayTameAtEveryIterationCount) {
  const auto model = on_grid(square(31), find_fabric("cotton_shirting"));
  for (const int iterations : {5, 10, 20, 40, 100}) {
    ClothState state = make_state(model->topology->mesh.positions);
    const auto integrator = make_newton({.iterations = iterations});
    for (int frame = 0; frame < 60; ++frame) {
      test::advance(*integrator, *model, hung_by(*model, {0, 31}), 1.0 / 60, 1, state);
      ASSERT_LT(compute_strain(*model, state).max, 0.1) << iterations << ", frame " << frame;
    }
  }
}

TEST(NewtonElements, ComeToTheRestOfImplicitEuler) {
  Fabric fabric = find_fabric("cotton_shirting");
  fabric.damping = 0.05;  // for a fast approach to rest
  for (const auto& model : {on_grid(square(10), fabric), on_mesh(square(10), fabric)}) {
    std::vector<int> row;
    for (int i = 0; i <= 10; ++i) row.push_back(i);
    Environment environment = hung_by(*model, row);
    environment.wind.drag = 1;
    ClothState a = make_state(model->topology->mesh.positions), b = a;
    test::advance(*make_newton({}), *model, environment, 1.0 / 60, 1200, a);
    test::advance(*make_implicit_euler({.tolerance = 1e-6}), *model, environment, 1.0 / 30, 200, b);
    std::vector<Vec3> rest;
    for (int i = 0; i < model->num_particles(); ++i) rest.push_back(b.position(i));
    EXPECT_LT(rms_distance(rest, a), 1e-3) << "of a metre; sideways little holds it";
  }
}

TEST(NewtonElements, FallFreelyAndKeepTheirMomentum) {
  for (const auto& model :
       {on_grid(square(9), find_fabric("silk")), on_mesh(square(9), find_fabric("silk"))}) {
    ClothState state = make_state(model->topology->mesh.positions);
    test::advance(*make_newton({}), *model, {}, 0.01, 20, state);
    for (int i = 0; i < model->num_particles(); ++i) {
      EXPECT_NEAR(state.v.get(i).y(), -9.81 * 0.2, 1e-5) << "floats";
      EXPECT_NEAR(state.position(i).y(), -9.81 * 0.2 * 0.2 / 2, 1e-6);
    }
    state = make_state(model->topology->mesh.positions);
    test::shake(state, 0.003, 0.5);
    const Vec3 before = compute_momentum(*model, state);
    test::advance(*make_newton({.iterations = 5}), *model, {.gravity = Vec3::Zero()}, 1.0 / 60, 60, state);
    EXPECT_LT((compute_momentum(*model, state) - before).norm(), 1e-6) << "of 0.02 kg at 0.5 m/s, in floats";
  }
}

TEST(NewtonElements, VibrateWithTheFrequencyOfTheirStiffnessAndTheDampingOfTheirTimeConstant) {
  // A sheet held along one side and stretched by a thousandth: ω = π/(2 L) √(C11/ρ), damping ratio ½ ω τ.
  Fabric fabric{.density = 0.2, .c11 = 50, .c22 = 50, .c12 = 0, .g = 20};
  const double omega = 1.5707963 * std::sqrt(fabric.c11 / fabric.density);
  fabric.damping = 2 * 0.1 / omega;
  for (const auto& model : {on_grid(square(20), fabric), on_mesh(square(20), fabric)}) {
    std::vector<int> held;
    for (int j = 0; j <= 20; ++j) held.push_back(21 * j);
    Environment environment = hung_by(*model, held);
    environment.gravity = Vec3::Zero();
    ClothState state = make_state(model->topology->mesh.positions);
    for (int i = 0; i < model->num_particles(); ++i)
      state.v.set(i, {1e-3 * omega * std::sin(1.5707963 * state.position(i).x()), 0, 0});
    const auto integrator = make_newton({.iterations = 100});
    const double omega_damped = omega * std::sqrt(1 - 0.1 * 0.1), step = 6.2831853 / omega_damped / 200;
    double high = 0, low = 0;
    for (int s = 0; s < 150; ++s) {
      test::advance(*integrator, *model, environment, step, 1, state);
      const double end = state.position(10 * 21 + 20).x() - 1;
      if (s == 49) high = end;
      if (s == 149) low = end;
    }
    // After a quarter and three quarters of a period. Strain is linear to a thousandth, cells are a
    // twentieth, BDF2 has a frequency error of 0.1 % of a radian.
    const double decay = std::exp(-0.1 * omega / omega_damped * 3.14159265);
    EXPECT_NEAR(-low / high, decay, 0.01);
    EXPECT_NEAR(high, 1e-3 * std::exp(-0.1 * omega / omega_damped * 1.5707963) * omega / omega_damped, 1e-5);
  }
}

TEST(NewtonElements, HaveTheSameBitsForAnyNumberOfThreadsAndEveryVectorWidth) {
  constexpr int kCells = 96;  // several chunks of work
  for (const auto& model :
       {on_grid(square(kCells), find_fabric("denim")), on_mesh(square(kCells), find_fabric("denim"))}) {
    std::vector<std::uint64_t> hashes;
    for (const SimdLevel level : {SimdLevel::baseline, best_simd_level()}) {
      for (const int threads : {1, 4}) {
        limit_simd_level(level);
        ClothState state = make_state(model->topology->mesh.positions);
        const auto jobs = make_jobs(threads);
        const auto integrator = make_newton({});
        for (int s = 0; s < 3; ++s)
          integrator->advance(*model, hung_by(*model, {0, kCells}), 1.0 / 60, *jobs, state);
        Hash hash;
        add_to_hash(state, hash);
        hashes.push_back(hash.value());
      }
    }
    limit_simd_level(best_simd_level());
    for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
  }
}

}  // namespace
}  // namespace weft::engine
