/// Stretches of border: the shorter way between vertices.

#include "weft/mesh/border_path.h"

#include <gtest/gtest.h>

#include "tests/message_of.h"
#include "weft/mesh/grid.h"

namespace weft::engine {
namespace {

/// 5 × 4 vertices: row by row, 0 to 19.
TriangleMesh sheet() {
  return build_grid_mesh({.size_x = 0.4, .size_z = 0.3, .cells_x = 4, .cells_z = 3}, GridDiagonals::parallel);
}

using Path = std::vector<int>;

Path find(const Path& stops) {
  const TriangleMesh mesh = sheet();
  return BorderPaths(mesh).find(stops);
}

TEST(BorderPath, TakesTheShorterWay) {
  EXPECT_EQ(find(Path{0, 4}), (Path{0, 1, 2, 3, 4}));
  EXPECT_EQ(find(Path{4, 0}), (Path{4, 3, 2, 1, 0}));
  EXPECT_EQ(find(Path{2, 9}), (Path{2, 3, 4, 9}));
}

TEST(BorderPath, GoesByWayOfTheStopsBetween) {
  EXPECT_EQ(find(Path{4, 14, 18, 15, 5}), (Path{4, 9, 14, 19, 18, 17, 16, 15, 10, 5}));
  EXPECT_EQ(find(Path{0, 9, 18, 0}).size(), 15u) << "all around";
}

TEST(BorderPath, MistakesAreNamed) {
  const auto message = [](const Path& stops) { return message_of([&] { find(stops); }); };
  EXPECT_EQ(message({3}), "a stretch of border has at least two vertices");
  EXPECT_EQ(message({6, 0}), "vertex 6 is not on a border");
  EXPECT_EQ(message({0, 6}), "vertex 6 is not on the border of vertex 0");
  EXPECT_EQ(
      message({0, 19}),
      "both ways along the border from vertex 0 to vertex 19 are equally long; name a vertex between them");
  EXPECT_EQ(message({0, 0}), "vertex 0 is named twice in a row");
}

}  // namespace
}  // namespace weft::engine
