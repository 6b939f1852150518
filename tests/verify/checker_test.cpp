#include "weft/verify/checker.h"

#include <gtest/gtest.h>

#include "weft/mesh/grid.h"

namespace weft::engine::verify {
namespace {

TriangleMesh sheet_at(double height) {
  TriangleMesh mesh =
      build_grid_mesh({.size_x = 1, .size_z = 1, .cells_x = 4, .cells_z = 4}, GridDiagonals::parallel);
  for (Vec3& p : mesh.positions) p.y() = height;
  return mesh;
}

NamedCloth cloth(const char* name, const TriangleMesh& mesh) {
  return {name, mesh.positions, mesh.triangles};
}

TEST(Checker, FindsNothingWhereThereIsNothing) {
  const TriangleMesh low = sheet_at(0.1), high = sheet_at(0.2);
  const Frame frame{{cloth("low", low), cloth("high", high)}, {{"ground", Plane{}}}};
  const FrameCheck check = check_frame(frame);
  EXPECT_EQ(check.intersections, 0);
  EXPECT_TRUE(check.first.empty());
  ASSERT_TRUE(check.deepest.has_value());
  EXPECT_EQ(check.penetration(), 0);
  EXPECT_EQ(describe(frame, *check.deepest), "nowhere");
}

TEST(Checker, NamesWhatCrossesAndWhatIsInside) {
  const TriangleMesh sheet = sheet_at(0.1);
  // A spike through the interior of one triangle of the sheet, as cloth and as collider.
  const TriangleMesh spike{{{0.1, -1, 0.2}, {0.11, -1, 0.2}, {0.1, 0.25, 0.2}}, {{0, 1, 2}}};
  const Frame frame{
      {cloth("sheet", sheet), cloth("rag", spike)},
      {{"ball", Sphere{{0.5, 0, 0.5}, 0.15}}, {"spike", MeshView{spike.positions, spike.triangles}}}};
  const FrameCheck check = check_frame(frame);
  EXPECT_EQ(check.intersections, 2) << "the rag lies on the spike in its own plane";
  ASSERT_EQ(check.first.size(), 2u);
  EXPECT_EQ(describe(frame, check.first[0]),
            "cloth \"sheet\" triangle 0 intersects cloth \"rag\" triangle 0");
  EXPECT_EQ(describe(frame, check.first[1]),
            "cloth \"sheet\" triangle 0 intersects collider \"spike\" triangle 0");
  EXPECT_NEAR(check.penetration(), 0.05, 1e-12);
  EXPECT_TRUE(describe(frame, *check.deepest).starts_with("cloth \"sheet\" triangle "));
  EXPECT_TRUE(describe(frame, *check.deepest).ends_with(" in collider \"ball\""));
  EXPECT_EQ(check_frame(frame, 1).first.size(), 1u);
  EXPECT_EQ(check_frame(frame, 1).intersections, 2);
}

TEST(Checker, LeavesOutWhatMayGoThroughEachOther) {
  const TriangleMesh low = sheet_at(0.1), high = sheet_at(0.2);
  TriangleMesh across = sheet_at(0);
  for (Vec3& p : across.positions) p = {0.51, p.x(), p.z()};
  Frame frame{{cloth("low", low), cloth("high", high), cloth("across", across)},
              {{"ball", Sphere{{0.2, 0.1, 0.5}, 0.15}}, {"ground", Plane{{0, 0.05, 0}, {0, 1, 0}}}}};
  const FrameCheck all = check_frame(frame);
  frame.non_colliding = {{"across", "low"}};
  const FrameCheck some = check_frame(frame);
  EXPECT_GT(some.intersections, 0) << "with the higher sheet";
  EXPECT_LT(some.intersections, all.intersections);
  frame.non_colliding.push_back({"high", "across"});
  EXPECT_EQ(check_frame(frame).intersections, 0) << "in whatever order they are named";
  EXPECT_NEAR(check_frame(frame).penetration(), 0.15, 1e-12) << "low in the ball";
  frame.non_colliding.push_back({"low", "ball"});
  const FrameCheck left = check_frame(frame);
  EXPECT_NEAR(left.penetration(), 0.05, 1e-6) << "high in the ball, across in the ground";
  frame.non_colliding.push_back({"high", "ball"});
  EXPECT_EQ(describe(frame, *check_frame(frame).deepest).substr(0, 14), "cloth \"across\"");
}

}  // namespace
}  // namespace weft::engine::verify
