#include "weft/verify/checker.h"

#include <gtest/gtest.h>

#include "weft/mesh/grid.h"

namespace weft::verify {
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
  // A spike through the inside of one triangle of the sheet, as cloth and as collider.
  const TriangleMesh spike{{{0.1, -1, 0.2}, {0.11, -1, 0.2}, {0.1, 0.25, 0.2}}, {{0, 1, 2}}};
  const Frame frame{
      {cloth("sheet", sheet), cloth("rag", spike)},
      {{"ball", Sphere{{0.5, 0, 0.5}, 0.15}}, {"spike", MeshView{spike.positions, spike.triangles}}}};
  const FrameCheck check = check_frame(frame);
  EXPECT_EQ(check.intersections, 2) << "the rag lies on the spike in its own plane";
  ASSERT_EQ(check.first.size(), 2u);
  EXPECT_EQ(describe(frame, check.first[0]), "cloth \"sheet\" triangle 0 crosses cloth \"rag\" triangle 0");
  EXPECT_EQ(describe(frame, check.first[1]),
            "cloth \"sheet\" triangle 0 crosses collider \"spike\" triangle 0");
  EXPECT_NEAR(check.penetration(), 0.05, 1e-12);
  EXPECT_TRUE(describe(frame, *check.deepest).starts_with("cloth \"sheet\" triangle "));
  EXPECT_TRUE(describe(frame, *check.deepest).ends_with(" in collider \"ball\""));
  EXPECT_EQ(check_frame(frame, 1).first.size(), 1u);
  EXPECT_EQ(check_frame(frame, 1).intersections, 2);
}

}  // namespace
}  // namespace weft::verify
