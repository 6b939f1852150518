#include "weft/animation/mesh_sequence.h"

#include <gtest/gtest.h>

#include "weft/error.h"

namespace weft::engine {
namespace {

using Key = MeshSequence::Key;

TEST(MeshSequence, MovesInStraightLinesBetweenItsKeysAndStaysOutside) {
  const MeshSequence sequence({Key{1, {Vec3(0, 0, 0)}}, Key{2, {Vec3(2, 0, 0)}}, Key{4, {Vec3(2, 4, 0)}}});
  const auto at = [&](double time) {
    std::vector<Vec3> positions;
    sequence.evaluate(time, positions);
    return positions[0];
  };
  EXPECT_EQ(at(0), Vec3(0, 0, 0));
  EXPECT_EQ(at(1), Vec3(0, 0, 0));
  EXPECT_EQ(at(1.25), Vec3(0.5, 0, 0));
  EXPECT_EQ(at(2), Vec3(2, 0, 0));
  EXPECT_EQ(at(3), Vec3(2, 2, 0));
  EXPECT_EQ(at(4), Vec3(2, 4, 0));
  EXPECT_EQ(at(100), Vec3(2, 4, 0));
}

TEST(MeshSequence, IsASourceOfVertices) {
  const MeshSequence sequence(
      {Key{1, {Vec3(0, 0, 0), Vec3(0, 0, 1)}}, Key{2, {Vec3(2, 0, 0), Vec3(0, 4, 1)}}});
  const VertexSource& source = sequence;
  EXPECT_EQ(source.num_vertices(), 2);
  std::vector<Vec3> positions(7);
  source.evaluate(1.25, positions);
  EXPECT_EQ(positions, (std::vector<Vec3>{Vec3(0.5, 0, 0), Vec3(0, 1, 1)}));
}

TEST(MeshSequence, OfKeysThatDoNotFitIsRefused) {
  EXPECT_THROW(MeshSequence({}), InputError);
  EXPECT_THROW(MeshSequence({Key{0, {Vec3::Zero()}}, Key{0, {Vec3::Zero()}}}), InputError);
  try {
    MeshSequence({Key{0, {Vec3::Zero()}}, Key{1, {Vec3::Zero(), Vec3::Zero()}}});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "key 1 of the mesh sequence has 2 vertices, the first key 1; all must have the same number");
  }
}

}  // namespace
}  // namespace weft::engine
