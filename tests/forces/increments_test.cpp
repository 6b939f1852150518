/// Fast kernels against the plain double formulas, and against themselves at other SIMD levels and thread
/// counts.

#include "weft/forces/increments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/support.h"
#include "weft/core/simd.h"
#include "weft/forces/damping.h"
#include "weft/forces/spring.h"

namespace weft::engine {
namespace {

using test::square;

struct Case {
  std::string name;
  std::shared_ptr<const ClothTopology> topology;
};

std::vector<Case> make_cases() {
  std::vector<Case> cases;
  for (const SpringModel model : {SpringModel::basic, SpringModel::simplified, SpringModel::alternating}) {
    // Widths around a full vector register, and the smallest grids.
    for (const auto& [cells_x, cells_z] :
         {std::pair{1, 1}, {1, 5}, {5, 1}, {14, 3}, {15, 7}, {16, 6}, {40, 9}}) {
      const Grid grid{
          .size_x = 0.1 * cells_x, .size_z = 0.12 * cells_z, .cells_x = cells_x, .cells_z = cells_z};
      cases.push_back(
          {std::string(to_string(model)) + " " + std::to_string(cells_x) + "x" + std::to_string(cells_z),
           build_grid_topology(grid, model)});
    }
  }
  cases.push_back({"mesh", test::mesh_of(square(9))});
  return cases;
}

const ClothMaterial kMaterial{.structural = 300, .shear = 150, .bend = 7, .damping = 0.03};

IncrementSettings make_settings(bool projected) {
  return {.step = 0.01f,
          .damping = 0.03f,
          .projected = projected,
          .stiffness_damping = 0.004f,
          .acceleration = {0.1, -9.81, 0.2},
          .wind_rate = 0.7f,
          .wind_velocity = {3, 1, -2}};
}

std::vector<double> weights_of(const ClothModel& model, double step) {
  std::vector<double> weight;
  for (int i = 0; i < model.num_particles(); ++i) {
    weight.push_back(1 / (model.mass[i] + step * step * model.stiffness_sum[i]));
  }
  return weight;
}

/// h w_i F_i, spring by spring in double precision.
std::vector<Vec3> reference_increments(const ClothModel& model, const ClothState& state,
                                       const IncrementSettings& s, const std::vector<double>& weight) {
  std::vector<Vec3> force;
  for (int i = 0; i < model.num_particles(); ++i) {
    force.push_back(model.mass[i] * (s.acceleration + s.wind_rate * (s.wind_velocity - state.v.get(i))));
  }
  for (const Spring& spring : model.topology->springs) {
    const double k = model.stiffness(spring.kind);
    const Vec3 d = state.x.get(spring.j) - state.x.get(spring.i),
               w = state.v.get(spring.j) - state.v.get(spring.i);
    const Vec3 damping =
        s.projected ? projected_damping_force(s.damping, d, w) : plain_damping_force(s.damping, w);
    const Vec3 f = spring_force(k, spring.rest_length, d) + damping + s.stiffness_damping * k * w;
    force[spring.i] += f;
    force[spring.j] -= f;
  }
  for (int i = 0; i < model.num_particles(); ++i) force[i] *= s.step * weight[i];
  return force;
}

TEST(Increments, AgreeWithTheFormulasOnEveryGridAndMesh) {
  const auto jobs = make_serial_jobs();
  for (const Case& c : make_cases()) {
    for (const bool projected : {false, true}) {
      const auto model = build_cloth_model(c.topology, kMaterial);
      ClothState state = make_state(c.topology->mesh.positions);
      test::shake(state, 0.02, 1);
      const IncrementSettings settings = make_settings(projected);
      const std::vector<double> weight = weights_of(*model, 0.01);
      IncrementField u;
      compute_increments(*model, state, settings, to_padded_floats(model->mass), to_padded_floats(weight),
                         *jobs, u);
      const std::vector<Vec3> expected = reference_increments(*model, state, settings, weight);
      for (int i = 0; i < model->num_particles(); ++i) {
        // Floats: about 12 terms of size up to 1 with relative errors of some 1e-7.
        EXPECT_LT((u.get(i) - expected[i]).norm(), 5e-6) << c.name << ", particle " << i;
      }
    }
  }
}

TEST(Increments, FilterIsTheJacobiSweepOfEquation14) {
  const auto jobs = make_serial_jobs();
  const float step = 0.01f;
  for (const Case& c : make_cases()) {
    const auto model = build_cloth_model(c.topology, kMaterial);
    const std::vector<double> weight = weights_of(*model, step);
    ClothState state = make_state(c.topology->mesh.positions);
    IncrementField u;
    u.fit(*model);
    Random random(3);
    std::vector<Vec3> expected;
    for (int i = 0; i < model->num_particles(); ++i) {
      u.set(i, test::random_vector(random, 1));
      state.v.set(i, test::random_vector(random, 1));
      expected.push_back(u.get(i) + 0.5 * state.v.get(i) + Vec3(0.1, 0.2, 0.3));
    }
    for (const Spring& s : c.topology->springs) {
      const double hhk = step * step * model->stiffness(s.kind);
      expected[s.i] += hhk * weight[s.i] * u.get(s.j);
      expected[s.j] += hhk * weight[s.j] * u.get(s.i);
    }
    const ClothState before = state;
    apply_filtered_increments(*model, u, step, to_padded_floats(weight),
                              {.drag_factor = 0.5f, .velocity_gain = {0.1, 0.2, 0.3}}, *jobs, state);
    for (int i = 0; i < model->num_particles(); ++i) {
      EXPECT_LT((state.v.get(i) - expected[i]).norm(), 2e-6) << c.name << ", particle " << i;
      EXPECT_LT((state.x.get(i) - before.x.get(i) - step * expected[i]).norm(), 2e-7) << c.name;
    }
  }
}

TEST(Increments, InternalForcesSumToZero) {
  const auto jobs = make_serial_jobs();
  for (const Case& c : make_cases()) {
    const auto model = build_cloth_model(c.topology, kMaterial);
    ClothState state = make_state(c.topology->mesh.positions);
    test::shake(state, 0.02, 1);
    const std::vector<double> ones(static_cast<std::size_t>(model->num_particles()), 1.0);
    IncrementField u;
    compute_increments(*model, state, {.step = 1, .damping = 0.03f}, to_padded_floats(model->mass),
                       to_padded_floats(ones), *jobs, u);
    Vec3 sum = Vec3::Zero();
    double size = 0;
    for (int i = 0; i < model->num_particles(); ++i) {
      sum += u.get(i);
      size += u.get(i).norm();
    }
    EXPECT_LT(sum.norm(), 1e-6 * size) << c.name;  // float rounding of each particle's own sum
  }
}

std::uint64_t hash_after_steps(const ClothModel& model, std::string_view integrator, JobSystem& jobs) {
  ClothState state = make_state(model.topology->mesh.positions);
  test::shake(state, 0.001, 0.1);
  Environment environment;
  environment.wind = {.velocity = {1, 0, 0}, .drag = 0.1};
  environment.pins = {.particle = {0}, .position = {state.position(0)}};
  const auto stepper = test::integrator(integrator);
  for (int s = 0; s < 5; ++s) stepper->advance(model, environment, 1e-4, jobs, state);
  Hash hash;
  add_to_hash(state, hash);
  return hash.value();
}

TEST(Increments, HaveTheSameBitsForAnyThreadsAndAnyVectorWidth) {
  std::vector<Case> cases;
  for (const SpringModel model : {SpringModel::basic, SpringModel::simplified, SpringModel::alternating}) {
    cases.push_back({std::string(to_string(model)), build_grid_topology(square(130), model)});
  }
  cases.push_back({"mesh", test::mesh_of(square(130))});
  for (const Case& c : cases) {
    const auto model = build_cloth_model(c.topology, kMaterial);
    for (const std::string_view name : {"explicit", "paper", "paper_fixed"}) {
      const std::uint64_t expected = hash_after_steps(*model, name, *make_serial_jobs());
      for (const int threads : {2, 5})
        EXPECT_EQ(hash_after_steps(*model, name, *make_jobs(threads)), expected);
      for (const SimdLevel level : {SimdLevel::baseline, SimdLevel::avx2, SimdLevel::avx512}) {
        limit_simd_level(level);
        EXPECT_EQ(hash_after_steps(*model, name, *make_serial_jobs()), expected)
            << c.name << ", " << name << ", " << to_string(simd_level());
      }
    }
  }
}

}  // namespace
}  // namespace weft::engine
