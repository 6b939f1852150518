/// Contact projection: no penetration, and only admissible changes of motion.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support.h"
#include "weft/geometry/distance.h"
#include "weft/mesh/clean.h"
#include "weft/mesh/solid.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

const ClothMaterial kCotton{.structural = 60, .shear = 20, .bend = 0.3, .damping = 2e-3, .friction = 0.3};

IntegratorSettings settings(const std::string& integrator) {
  return {.integrator = integrator, .explicit_euler = {}, .paper = {}, .implicit_euler = {}};
}

/// A sheet of 8 x 8 coarse cells of 10 cm above the origin, centred at `middle`.
ClothId add_sheet(World& world, const Vec3& middle, int cells = 8, double size = 0.8, double turn_deg = 0,
                  const Vec3& velocity = Vec3::Zero(), const ClothMaterial& material = kCotton) {
  const auto topology = build_grid_topology(test::square(cells, size), SpringModel::alternating);
  const Mat3 turn = rotation_from_angles_deg({0, turn_deg, 0});
  std::vector<Vec3> positions;
  for (const Vec3& p : topology->mesh.positions)
    positions.push_back(middle + turn * (p - Vec3(size / 2, 0, size / 2)));
  return world.add_cloth({.name = "sheet",
                          .topology = topology,
                          .material = material,
                          .positions = positions,
                          .velocity = velocity});
}

/// The deepest of sample points spread over all triangles, > 0 inside [m].
double deepest_sample(const World& world, ClothId cloth, const Collider& collider) {
  constexpr int kCuts = 8;
  const ColliderShape shape = shape_at(collider, world.time());
  const ClothState& state = world.state(cloth);
  double lowest = std::numeric_limits<double>::infinity();
  for (const Triangle& t : world.model(cloth).topology->mesh.triangles) {
    const Vec3 a = state.position(t[0]), b = state.position(t[1]), c = state.position(t[2]);
    for (int i = 0; i <= kCuts; ++i) {
      for (int j = 0; i + j <= kCuts; ++j) {
        const Vec3 weights = Vec3(i, j, kCuts - i - j) / kCuts;
        lowest = std::min(lowest, signed_distance(shape, point_at(weights, a, b, c)).distance);
      }
    }
  }
  return -lowest;
}

struct ContactProjectionCase {
  const char* name;
  Collider collider;
  const char* integrator;
  int steps_per_second;
};

std::vector<ContactProjectionCase> make_contact_projection_cases() {
  // A corner up: the box's diagonal is vertical.
  const Mat3 corner_up = Eigen::Quaterniond::FromTwoVectors(Vec3::Ones(), Vec3::UnitY()).toRotationMatrix();
  const Mat3 edge_up = rotation_from_angles_deg({0, 20, 0}) * rotation_from_angles_deg({45, 0, 0});
  const Collider colliders[] = {
      {"corner", OrientedBox{Vec3(0, -0.2 * std::sqrt(3.0), 0), Vec3::Constant(0.2), corner_up}, 0.3, {}},
      {"edge", OrientedBox{Vec3(0, -0.1 * std::sqrt(2.0), 0), Vec3(0.3, 0.1, 0.1), edge_up}, 0.3, {}},
      {"small_ball", Sphere{{0, -0.04, 0}, 0.04}, 0.3, {}},
      {"ball", Sphere{{0, -0.25, 0}, 0.25}, 0.3, {}},
      {"capsule", Capsule{{-0.3, -0.03, 0.05}, {0.3, -0.03, -0.05}, 0.03}, 0.3, {}}};
  std::vector<ContactProjectionCase> cases;
  for (const Collider& c : colliders) {
    cases.push_back({c.name.c_str(), c, "paper", 600});
    cases.push_back({c.name.c_str(), c, "implicit_euler", 60});
  }
  for (ContactProjectionCase& c : cases) c.name = c.collider.name.c_str();
  return cases;
}

class ContactProjection : public testing::TestWithParam<int> {};

TEST_P(ContactProjection, NoPointOfATriangleGetsIntoACollider) {
  const ContactProjectionCase c = make_contact_projection_cases()[GetParam()];
  World world;
  world.set_integrator(settings(c.integrator));
  world.add_collider(c.collider);
  // A corner, an edge or a cap lies under the middle of a cell.
  const ClothId cloth = add_sheet(world, {0.05, 0.02, 0.03});
  double deepest = -1;
  for (int s = 0; s < 4 * c.steps_per_second; ++s) {
    const StepReport report = world.step(1.0 / c.steps_per_second);
    ASSERT_TRUE(report.ok);
    deepest = std::max(deepest, deepest_sample(world, cloth, c.collider));
  }
  RecordProperty("deepest_um", std::to_string(deepest * 1e6));
  // At 60 steps per second this coarse sheet lands on the edge with one step of 0.16 mm.
  const bool is_hard_landing = c.collider.name == "edge" && c.integrator == std::string("implicit_euler");
  EXPECT_LT(deepest, is_hard_landing ? 2e-4 : 1e-4) << "half the thickness is 0.5 mm";
  EXPECT_GT(deepest, -0.01) << "and it did land";
}

INSTANTIATE_TEST_SUITE_P(Scenes, ContactProjection, testing::Range(0, 10), [](const auto& test) {
  const ContactProjectionCase c = make_contact_projection_cases()[test.param];
  return c.collider.name + "_" + c.integrator;
});

class ContactProjectionMesh : public testing::TestWithParam<const char*> {};

/// Number of cloth vertices inside the closed mesh.
int num_inside(const World& world, ClothId cloth, const TriangleMesh& mesh) {
  std::vector<Vec3> points;
  for (int i = 0; i < world.model(cloth).num_particles(); ++i)
    points.push_back(world.state(cloth).position(i));
  const std::vector<int> winding = compute_winding_numbers(mesh, points);
  return static_cast<int>(std::count_if(winding.begin(), winding.end(), [](int w) { return w != 0; }));
}

TEST_P(ContactProjectionMesh, NoVertexGetsIntoAClosedMesh) {
  const int steps_per_second = GetParam() == std::string("implicit_euler") ? 60 : 300;
  for (const double offset : {0.013, 0.0}) {  // 0: vertices and edges lie exactly above each other
    World world;
    world.set_integrator(settings(GetParam()));
    const auto mesh = std::make_shared<TriangleMesh>(make_sphere_mesh({0, -0.25, 0}, 0.25, 10));
    MeshShape shape;
    shape.mesh = mesh;
    world.add_collider({"ball", shape, 0.3, {}});
    const ClothId cloth = add_sheet(world, {offset, 0.02, offset}, 12, 0.6);
    int most = 0;
    for (int s = 0; s < 2 * steps_per_second; ++s) {
      ASSERT_TRUE(world.step(1.0 / steps_per_second).ok);
      most = std::max(most, num_inside(world, cloth, *mesh));
    }
    EXPECT_EQ(most, 0) << "offset " << offset;
    EXPECT_GT(compute_center_of_mass(world.model(cloth), world.state(cloth)).y(), -0.6)
        << "it did not slide off";
  }
}

INSTANTIATE_TEST_SUITE_P(Integrators, ContactProjectionMesh,
                         testing::Values("explicit", "paper_fixed", "implicit_euler"),
                         [](const auto& test) { return std::string(test.param); });

/// Height of a sheet's lowest particle over the top face of a box of 0.4 m around the origin, which is part
/// of `mesh`, after a second; the sheet starts around `middle`.
double lowest_over_box(const TriangleMesh& mesh, const Vec3& middle) {
  World world;
  world.set_integrator(settings("implicit_euler"));
  MeshShape shape;
  shape.mesh = std::make_shared<const TriangleMesh>(mesh);
  world.add_collider({"body", shape, 0.3, {}});
  const ClothId cloth = add_sheet(world, middle, 4, 0.1);
  for (int s = 0; s < 60; ++s) EXPECT_TRUE(world.step(1.0 / 60).ok);
  double lowest = 1;
  for (int i = 0; i < world.model(cloth).num_particles(); ++i) {
    lowest = std::min(lowest, world.state(cloth).position(i).y() - 0.2);
  }
  return lowest;
}

TriangleMesh welded_box(const Vec3& center) {
  return clean_mesh(make_box_mesh(center, Vec3::Constant(0.2), Mat3::Identity()), {.weld_distance = 1e-9})
      .mesh;
}

TEST(ContactSystem, PushesClothOutOfSolidsThatMeetAtAnEdge) {
  // The edge between them has four triangles. Both are still solids with a defined outside. The cloth lies on
  // one triangle, because edges have no defined side.
  TriangleMesh two = welded_box(Vec3::Zero());
  const TriangleMesh other = welded_box({0.4, -0.4, 0});
  two.positions.insert(two.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& [a, b, c] : other.triangles) two.triangles.push_back({8 + a, 8 + b, 8 + c});
  two = clean_mesh(two, {.weld_distance = 1e-9}).mesh;
  ASSERT_EQ(two.num_vertices(), 14);
  EXPECT_GT(lowest_over_box(two, {0.1, 0.1997, -0.1}), 0);
}

TEST(ContactSystem, DoesNotDrawClothInAtATriangleThatFacesTheWrongWay) {
  // The outside is undefined then: cloth stays on the side that it comes from.
  for (std::size_t t = 0; t < 12; ++t) {
    TriangleMesh twisted = welded_box(Vec3::Zero());
    std::swap(twisted.triangles[t][0], twisted.triangles[t][1]);
    EXPECT_GT(lowest_over_box(twisted, {0.01, 0.205, 0.01}), 0) << "triangle " << t;
  }
}

TEST(ContactSystem, HoldsClothOffARidgeThatItsVerticesLieOn) {
  // An open roof of two planes under a sheet whose middle row lies exactly along the ridge: the row's nearest
  // feature is the ridge, an edge, and no face.
  for (const char* integrator : {"explicit", "implicit_euler"}) {
    auto roof = std::make_shared<TriangleMesh>();
    roof->positions = {{-1, -0.6, -1}, {1, -0.6, -1}, {-1, 0, 0}, {1, 0, 0}, {-1, -0.6, 1}, {1, -0.6, 1}};
    roof->triangles = {{0, 2, 1}, {1, 2, 3}, {2, 4, 3}, {3, 4, 5}};
    MeshShape shape;
    shape.mesh = roof;
    World world;
    world.set_integrator(settings(integrator));
    world.add_collider({"roof", shape, 0.5, {}});
    const ClothId cloth = add_sheet(world, {0, 0.01, 0}, 8, 0.8);
    for (int s = 0; s < 60; ++s) ASSERT_TRUE(world.step(1.0 / 60).ok);
    double lowest = 1;  // over the roof
    for (int i = 0; i < world.model(cloth).num_particles(); ++i) {
      const Vec3 p = world.state(cloth).position(i);
      lowest = std::min(lowest, p.y() + 0.6 * std::abs(p.z()));
    }
    EXPECT_GT(lowest, 0) << integrator;
  }
}

/// Totals over all cloths.
struct Totals {
  Vec3 momentum = Vec3::Zero();
  double energy = 0;  // kinetic and elastic [J]
};

Totals measure(const World& world) {
  Totals totals;
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothModel& model = world.model(world.cloth(c));
    const ClothState& state = world.state(world.cloth(c));
    totals.momentum += compute_momentum(model, state);
    totals.energy += compute_kinetic_energy(model, state) + compute_elastic_energy(model, state);
  }
  return totals;
}

class Collision : public testing::TestWithParam<double> {};

TEST_P(Collision, OfTwoFreeClothsKeepsMomentumAndGainsNoEnergy) {
  World world;
  world.set_gravity(Vec3::Zero());
  world.set_integrator(settings("explicit"));
  ClothMaterial material = kCotton;
  material.friction = GetParam();
  // Rotated against each other, off centre, one heavier; each starts slightly above the other.
  ClothMaterial heavy = material;
  heavy.density = 0.5;
  add_sheet(world, {0, 0.01, 0}, 6, 0.3, 0, {0.3, -1, 0}, material);
  add_sheet(world, {0.05, -0.01, 0.03}, 6, 0.3, 30, {0, 0.5, 0.2}, heavy);
  const Totals before = measure(world);
  double size = 0;  // of the momenta [kg m/s]
  for (int c = 0; c < 2; ++c)
    size += compute_momentum(world.model(world.cloth(c)), world.state(world.cloth(c))).norm();
  double highest = before.energy;
  for (int s = 0; s < 300; ++s) {
    ASSERT_TRUE(world.step(1.0 / 1000).ok);
    const Totals now = measure(world);
    // Velocities are floats: each step rounds each by a relative 6e-8, at random.
    EXPECT_LT((now.momentum - before.momentum).norm(), 2e-6 * size) << s;
    highest = std::max(highest, now.energy);
  }
  EXPECT_LE(highest, before.energy * (1 + 1e-3)) << "semi-implicit Euler's energy swings by the share of h ω";
  EXPECT_LT(measure(world).energy, 0.95 * before.energy) << "the blow has no bounce, and so takes energy";
}

INSTANTIATE_TEST_SUITE_P(Frictions, Collision, testing::Values(0.0, 0.5));

}  // namespace
}  // namespace weft::engine
