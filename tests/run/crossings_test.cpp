#include "weft/mesh.h"

#include <gtest/gtest.h>

#include <limits>

#include "weft/error.h"

namespace weft {
namespace {

const Surface kFlat{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, .triangles = {{0, 2, 1}}};
const Surface kUpright{.positions = {{0.2, -1, 0.2}, {0.2, 1, 0.2}, {0.2, -1, 9}}, .triangles = {{0, 1, 2}}};

TEST(FindCrossings, NamesTheTrianglesThatCross) {
  EXPECT_EQ(find_crossings({kFlat, kUpright}), std::vector<Crossing>({{0, 0, 1, 0}}));
  Surface above = kUpright;
  for (Vec3& p : above.positions) p.y += 1;
  EXPECT_TRUE(find_crossings({kFlat, above}).empty()) << "a vertex that touches does not cross";
  Surface body = kFlat, wall = kUpright;
  body.is_cloth = wall.is_cloth = false;
  EXPECT_TRUE(find_crossings({body, wall}).empty()) << "bodies may cross each other";
}

TEST(FindCrossings, RefusesWhatIsNoMesh) {
  Surface broken = kFlat;
  broken.triangles[0][1] = 3;
  EXPECT_THROW(find_crossings({broken}), InputError);
  broken = kFlat;
  broken.positions[2].z = std::numeric_limits<double>::infinity();
  EXPECT_THROW(find_crossings({kUpright, broken}), InputError);
}

}  // namespace
}  // namespace weft
