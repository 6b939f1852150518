/// Fast kernels of membranes and bending against their reference functions in double precision.

#include <gtest/gtest.h>

#include "tests/forces/sheets.h"
#include "tests/support.h"
#include "weft/core/simd.h"
#include "weft/error.h"
#include "weft/forces/bending.h"
#include "weft/forces/membrane_patch.h"
#include "weft/forces/potential.h"

namespace weft::engine {
namespace {

using test::SheetKind;

/// All numbers differ, so that a mix-up is detected.
const Fabric kFabric = {.density = 0.2,
                        .c11 = 900,
                        .c22 = 2000,
                        .c12 = 300,
                        .g = 120,
                        .bend_warp = 2e-4,
                        .bend_weft = 5e-4,
                        .bend_bias = 4e-4,
                        .damping = 0,
                        .thickness = 1e-3,
                        .friction = 0.3,
                        .strain_limit = 0,
                        .stretch_warp = {},
                        .stretch_weft = {}};
constexpr double kLimit = 0.03;
constexpr Grid kGrid = {.size_x = 1, .size_z = 0.7, .cells_x = 21, .cells_z = 9};

struct Sheet {
  std::string name;
  std::shared_ptr<const ClothModel> model;
};

std::shared_ptr<const ClothModel> model_of(const std::shared_ptr<const ClothTopology>& topology,
                                           const std::shared_ptr<const ClothElements>& elements) {
  return build_cloth_model(topology, {.density = kFabric.density, .structural = 0, .shear = 0, .bend = 0},
                           elements);
}

/// Sheets of every kind of mesh.
void add_sheets(const Fabric& fabric, std::vector<Sheet>& sheets) {
  for (const SpringModel model : {SpringModel::simplified, SpringModel::alternating}) {
    const auto topology = build_grid_topology(kGrid, model);
    for (const GridWarp warp : {GridWarp::first_axis, GridWarp::second_axis}) {
      sheets.push_back({std::string(to_string(model)) + (warp == GridWarp::first_axis ? ", x" : ", z"),
                        model_of(topology, build_grid_elements(kGrid, topology->mesh, warp, fabric))});
    }
  }
  for (const SheetKind kind : {SheetKind::parallel, SheetKind::random}) {
    const auto topology = build_mesh_topology(make_sheet(kind, kGrid));
    const WarpField warp = warp_from_direction(topology->mesh, {2, 0, 1});
    sheets.push_back(
        {test::to_string(kind), model_of(topology, build_mesh_elements(topology->mesh, warp, fabric))});
  }
}

std::vector<Sheet> linear_sheets(double damping) {
  Fabric fabric = kFabric;
  fabric.damping = damping;
  std::vector<Sheet> sheets;
  add_sheets(fabric, sheets);
  return sheets;
}

/// Also with a strain limit, with stretch curves, and with both. Most triangles of a Bent sheet are beyond
/// the limit and the curves' kinks, in one direction or in both.
std::vector<Sheet> all_sheets(double damping) {
  std::vector<Sheet> sheets = linear_sheets(damping);
  Fabric fabric = kFabric;
  fabric.damping = damping;
  fabric.strain_limit = kLimit;
  add_sheets(fabric, sheets);
  fabric.stretch_warp = {{0.02, 12}, {0.05, 60}, {0.1, 240}};
  fabric.stretch_weft = {{0.03, 90}, {0.06, 150}};
  add_sheets(fabric, sheets);
  fabric.strain_limit = 0;
  add_sheets(fabric, sheets);
  return sheets;
}

/// A potential without inertia around a stretched, sheared and crumpled sheet.
struct Bent {
  const ClothModel& model;
  IncrementalPotential potential;
  Vec3Array e;
  std::unique_ptr<JobSystem> jobs = make_jobs(1);

  explicit Bent(const ClothModel& m, double rate = 0) : model(m) {
    potential.fit(m, rate);
    e = Vec3Array(potential.rows().size());
    Random random(3);
    for (int i = 0; i < m.num_particles(); ++i) {
      const Vec3& p = m.topology->mesh.positions[i];
      const Vec3 place(1.05 * p.x() + 0.1 * p.z(), 0.2 * p.x() * p.x() - 0.1 * p.z(), 0.97 * p.z());
      potential.target.set(potential.rows().index(i), place + test::random_vector(random, 0.004));
    }
  }

  int at(int i) const { return potential.rows().index(i); }

  std::vector<Vec3> positions() const {
    std::vector<Vec3> x;
    for (int i = 0; i < model.num_particles(); ++i) x.push_back(potential.target.get(at(i)) + e.get(at(i)));
    return x;
  }
};

double norm(const std::vector<Vec3>& field) {
  double sum = 0;
  for (const Vec3& v : field) sum += v.squaredNorm();
  return std::sqrt(sum);
}

TEST(ElementPotential, IsTheSumOfTheElementsOnGridsAndMeshes) {
  for (const Sheet& sheet : all_sheets(0)) {
    Bent bent(*sheet.model);
    const ClothElements& elements = *sheet.model->elements;
    Vec3Array force(bent.e.size());
    const double energy = bent.potential.linearise(bent.e, *bent.jobs, force);
    const std::vector<Vec3> x = bent.positions();
    double expected = bending_energy(elements.bending, x);
    std::vector<Vec3> difference(x.size(), Vec3::Zero());
    for (const MembranePatch& patch : elements.patches) {
      expected += patch_energy(patch, elements.law(), corners_of(patch, x));
      const PatchCorners f = patch_force(patch, elements.law(), corners_of(patch, x));
      for (int v = 0; v < patch.num_vertices(); ++v) difference[patch.vertices[v]] += f[v];
    }
    add_bending_force(elements.bending, x, difference);
    const double size = norm(difference);
    for (int i = 0; i < sheet.model->num_particles(); ++i) difference[i] -= force.get(bent.at(i));
    // Floats of positions of a metre, cells of 5 cm and stiffness of 1000 N/m.
    EXPECT_NEAR(energy / expected, 1, 1e-5) << sheet.name;
    EXPECT_LT(norm(difference), 1e-5 * size) << sheet.name;
    EXPECT_EQ(bent.potential.energy(bent.e, *bent.jobs), energy) << sheet.name;
  }
}

TEST(ElementPotential, MultipliesByTheFilteredHessian) {
  for (const Sheet& sheet : all_sheets(0)) {
    Bent bent(*sheet.model);
    const ClothElements& elements = *sheet.model->elements;
    Vec3Array force(bent.e.size()), p(bent.e.size()), q(bent.e.size());
    bent.potential.linearise(bent.e, *bent.jobs, force);
    const std::vector<Vec3> x = bent.positions();
    std::vector<Vec3> direction, expected(x.size(), Vec3::Zero());
    Random random(5);
    for (int i = 0; i < sheet.model->num_particles(); ++i) {
      p.set(bent.at(i), test::random_vector(random, 1));
      direction.push_back(p.get(bent.at(i)));
    }
    const double dot = bent.potential.multiply(p, *bent.jobs, q);
    add_bending_force(elements.bending, direction, expected);
    for (Vec3& v : expected) v = -v;
    for (const MembranePatch& patch : elements.patches) {
      const PatchHessian hessian = patch_hessian(patch, elements.law(), corners_of(patch, x));
      for (int a = 0; a < patch.num_vertices(); ++a) {
        for (int b = 0; b < patch.num_vertices(); ++b)
          expected[patch.vertices[a]] +=
              patch_block(patch, hessian, a, b, StressFilter::absolute) * direction[patch.vertices[b]];
      }
    }
    const double size = norm(expected);
    double expected_dot = 0;
    for (std::size_t i = 0; i < x.size(); ++i) expected_dot += expected[i].dot(direction[i]);
    for (int i = 0; i < sheet.model->num_particles(); ++i) expected[i] -= q.get(bent.at(i));
    EXPECT_LT(norm(expected), 1e-5 * size) << sheet.name;
    EXPECT_NEAR(dot / expected_dot, 1, 1e-5) << sheet.name;
  }
}

TEST(ElementPotential, DampedForceIsTheGradientOfItsEnergy) {
  for (const Sheet& sheet : linear_sheets(0.02)) {
    Bent bent(*sheet.model, 60);
    Vec3Array start(sheet.model->num_particles()), moved(sheet.model->num_particles());
    Random random(7);
    const std::vector<Vec3> x = bent.positions();
    for (int i = 0; i < sheet.model->num_particles(); ++i) {
      moved.set(i, test::random_vector(random, 0.005));
      start.set(i, x[i] + test::random_vector(random, 0.005));
      bent.potential.velocity_offset.set(bent.at(i), test::random_vector(random, 0.005));
    }
    bent.potential.remember(start, moved, 1.0 / 3, *bent.jobs);
    Vec3Array force(bent.e.size()), there = bent.e, back = bent.e;
    bent.potential.linearise(bent.e, *bent.jobs, force);
    double work = 0;
    for (int i = 0; i < sheet.model->num_particles(); ++i) {
      const Vec3 step = test::random_vector(random, 2e-4);
      there.set(bent.at(i), step);
      back.set(bent.at(i), -step);
      work += there.get(bent.at(i)).dot(force.get(bent.at(i)));
    }
    const double slope =
        (bent.potential.energy(back, *bent.jobs) - bent.potential.energy(there, *bent.jobs)) / 2;
    EXPECT_NEAR(slope / work, 1, 2e-3) << sheet.name << ": third order of steps of 0.4 % of a cell";
  }
}

/// Damping energy of a sheet at rest strain that has moved there from `start`.
double viscous_energy(const ClothModel& model, const std::vector<Vec3>& start, const std::vector<Vec3>& end) {
  IncrementalPotential potential;
  potential.fit(model, 100);
  const auto jobs = make_serial_jobs();
  Vec3Array x(model.num_particles()), displacement(model.num_particles()), e(potential.rows().size());
  for (int i = 0; i < model.num_particles(); ++i) {
    const int at = potential.rows().index(i);
    x.set(i, start[i]);
    potential.target.set(at, end[i]);
    potential.velocity_offset.set(at, end[i] - start[i]);
  }
  potential.remember(x, displacement, 0, *jobs);
  const double damped = potential.energy(e, *jobs);
  potential.fit(model, 0);
  return damped - potential.energy(e, *jobs);
}

TEST(ElementPotential, DampingIsTheTimeConstantTimesTheRateOfStrainAndLeavesARigidRotationAlone) {
  constexpr double kTau = 0.02, kShare = kTau * 100;
  for (const Sheet& sheet : linear_sheets(kTau)) {
    const ClothElements& elements = *sheet.model->elements;
    const TriangleMesh& mesh = sheet.model->topology->mesh;
    const auto stretched = test::mapped(mesh, [](const Vec3& p) { return Vec3(1.01 * p.x(), 0, p.z()); });
    double elastic = 0;
    for (const MembranePatch& patch : elements.patches)
      elastic += patch_energy(patch, elements.law(), corners_of(patch, stretched));
    // From rest to e: ½ A η eᵀ C e less the constant η/(1 + η) ½ e₀ᵀ C e₀ = 0.
    EXPECT_NEAR(viscous_energy(*sheet.model, mesh.positions, stretched), kShare * elastic,
                1e-4 * kShare * elastic)
        << sheet.name;
    const auto turned =
        test::mapped(mesh, [](const Vec3& p) { return Vec3(0.8 * p.x(), 0.6 * p.x(), p.z()); });
    EXPECT_LT(viscous_energy(*sheet.model, mesh.positions, turned), 1e-5 * elastic) << sheet.name;
  }
}

TEST(ElementPotential, HasTheSameBitsForAnyNumberOfThreadsAndEveryVectorWidth) {
  for (const Sheet& sheet : all_sheets(0.02)) {
    std::vector<double> energies;
    std::vector<std::vector<Vec3>> products;
    for (const SimdLevel level : {SimdLevel::baseline, SimdLevel::avx2, SimdLevel::avx512}) {
      for (const int threads : {1, 3}) {
        limit_simd_level(level);
        Bent bent(*sheet.model, 60);
        bent.jobs = make_jobs(threads);
        Vec3Array force(bent.e.size()), q(bent.e.size());
        energies.push_back(bent.potential.linearise(bent.e, *bent.jobs, force));
        energies.back() += bent.potential.multiply(force, *bent.jobs, q);
        products.emplace_back();
        for (int i = 0; i < sheet.model->num_particles(); ++i) products.back().push_back(q.get(bent.at(i)));
      }
    }
    limit_simd_level(best_simd_level());
    for (std::size_t k = 1; k < energies.size(); ++k) {
      EXPECT_EQ(energies[k], energies[0]) << sheet.name;
      EXPECT_EQ(products[k], products[0]) << sheet.name;
    }
  }
}

TEST(ElementPotential, RefusesHinges) {
  const auto topology = build_mesh_topology(make_sheet(SheetKind::random, 4));
  const auto elements = build_mesh_elements(
      topology->mesh, warp_from_direction(topology->mesh, Vec3::UnitX()), kFabric, BendingModel::hinges);
  IncrementalPotential potential;
  EXPECT_THROW(potential.fit(*model_of(topology, elements), 0), InputError);
}

}  // namespace
}  // namespace weft::engine
