/// The figure and the garments of tools/wardrobe have the documented properties, and a shirt that intersects
/// the arms at the start is repaired.

#include "tools/wardrobe/wardrobe.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tools/wardrobe/figure.h"
#include "tools/wardrobe/garments.h"
#include "weft/core/job_system.h"
#include "weft/fabric.h"
#include "weft/fabric/elements.h"
#include "weft/mesh/solid.h"
#include "weft/model/cloth_model.h"
#include "weft/run/frame_checks.h"
#include "weft/world/measures.h"

namespace weft::engine::wardrobe {
namespace {

constexpr double kCoarse = 0.02;  // [m]

TEST(Wardrobe, TheFigureIsClosedAndItsHairCoversItsHead) {
  const Figure figure = make_figure(kCoarse);
  EXPECT_TRUE(is_closed(count_surface_edges(figure.mesh)));
  TriangleMesh mesh = figure.mesh;
  const TurnedShells shells = turn_shells_outwards(mesh);
  EXPECT_EQ(shells.count, 2);
  EXPECT_EQ(shells.turned, 0);
  EXPECT_EQ(compute_winding_numbers(mesh, {{0, 1.65, 0}, {0, 1.3, 0}, {0, 0.3, 0}}),
            (std::vector<int>{2, 1, 0}));
  EXPECT_NEAR(compute_signed_volume(mesh), 0.07, 0.02) << "a person";
}

TEST(Wardrobe, EveryMotionStartsAtRestAndTheKickReachesFifteenMetresPerSecond) {
  const Figure figure = make_figure(kCoarse);
  for (const std::string& motion : motion_names()) {
    const std::vector<Vec3> start = pose_figure(figure, pose_at(motion, 0));
    for (std::size_t v = 0; v < start.size(); ++v)
      ASSERT_LT((start[v] - figure.mesh.positions[v]).norm(), 1e-6) << motion;
  }
  constexpr double kFrame = 1.0 / 60;
  double fastest = 0;
  std::vector<Vec3> before = figure.mesh.positions;
  for (int frame = 1; frame <= 60; ++frame) {
    const std::vector<Vec3> now = pose_figure(figure, pose_at("kick", frame * kFrame));
    for (std::size_t v = 0; v < now.size(); ++v)
      fastest = std::max(fastest, (now[v] - before[v]).norm() / kFrame);
    before = now;
  }
  EXPECT_GT(fastest, 14);
  EXPECT_LT(fastest, 20);
}

TEST(Wardrobe, AShirtThatStartsThroughTheArmsIsPutOn) {
  const Figure figure = make_figure(kCoarse);
  const TriangleMesh shirt = make_shirt(kCoarse, 4);
  const Fabric fabric = find_fabric("cotton_shirting");
  World world;
  world.add_collider(
      {"figure", MeshShape{.mesh = std::make_shared<const TriangleMesh>(figure.mesh)}, 0.3, {}});
  const ClothId id = world.add_cloth(
      {.name = "shirt",
       .topology = build_mesh_topology(shirt),
       .material = {.density = fabric.density, .damping = fabric.damping, .thickness = fabric.thickness},
       .elements = build_mesh_elements(shirt, warp_from_direction(shirt, Vec3::UnitY()), fabric)});
  ASSERT_GT(verify::check_frame(WorldFrames(world).now().frame, 1).intersections, 100)
      << "else it is too easy";
  const UntangleReport report = world.untangle();
  for (const std::string& left : report.left) ADD_FAILURE() << left;
  EXPECT_EQ(verify::check_frame(WorldFrames(world).now().frame, 1).intersections, 0);
  const std::optional<Stretches> stretches = compute_principal_stretches(world.model(id), world.state(id));
  ASSERT_TRUE(stretches);
  EXPECT_LT(stretches->max, 1.1);
  for (int frame = 0; frame < 10; ++frame) {
    ASSERT_TRUE(world.step(1.0 / 60).ok);
    ASSERT_EQ(verify::check_frame(WorldFrames(world).now().frame, 1).intersections, 0) << frame;
  }
}

}  // namespace
}  // namespace weft::engine::wardrobe
