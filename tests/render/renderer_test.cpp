/// The renderer's calls, checked without OpenGL.

#include "weft/render/renderer.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/render/pictures.h"
#include "weft/mesh/vertex_normals.h"
#include "weft/render/mock_device.h"

namespace weft::engine {
namespace {

struct Drawn {
  std::vector<std::string> log;
  Image image;

  long count(const std::string& what) const { return std::count(log.begin(), log.end(), what); }
};

Drawn draw_with_mock(const Picture& picture, const RenderSettings& settings = {}) {
  auto device = std::make_unique<MockDevice>();
  const MockDevice& mock = *device;
  Renderer renderer(std::move(device), settings);
  const Image image = renderer.draw(picture, {320, 180});
  return {mock.log(), image};
}

TEST(Renderer, GoesThroughItsStagesInOrder) {
  const std::vector<std::string> expected = {"pass shadow",
                                             "draw depth",
                                             "draw depth",  // ball and cloth
                                             "pass surfaces",
                                             "draw solid",
                                             "draw fabric",
                                             "draw solid",  // the ground
                                             "pass sunlight",
                                             "draw sun",
                                             "pass rough occlusion",
                                             "draw occlusion",
                                             "pass occlusion",
                                             "draw blur",
                                             "pass lit",
                                             "draw light",
                                             "pass colour",
                                             "draw surface",
                                             "draw surface",
                                             "draw surface",
                                             "draw line",
                                             "draw dot",
                                             "draw sky",
                                             "resolve colour picture",
                                             "read picture"};
  const Drawn drawn = draw_with_mock(make_still_life());
  EXPECT_EQ(drawn.log, expected);
  EXPECT_EQ(drawn.image.width, 320);
  EXPECT_EQ(drawn.image.height, 180);
}

TEST(Renderer, LeavesOutSkyAndGroundWhereTransparent) {
  Picture picture = make_still_life();
  picture.transparent = true;
  const Drawn drawn = draw_with_mock(picture);
  EXPECT_EQ(drawn.count("draw sky"), 0);
  EXPECT_EQ(drawn.count("draw solid") + drawn.count("draw fabric"), 2) << "no ground";
  EXPECT_EQ(drawn.count("draw surface"), 2);
}

TEST(Renderer, DrawsNoDepthThatNobodyReads) {
  const Drawn drawn = draw_with_mock(make_still_life(), {.samples = 1, .shadow_size = 0, .occlusion = false});
  EXPECT_EQ(drawn.count("draw depth"), 0);
  EXPECT_EQ(drawn.count("draw solid") + drawn.count("draw fabric"), 3);
}

TEST(Renderer, DrawsPicturesOfNothingAndOfOddThings) {
  draw_with_mock({});  // the mock throws if anything is not finite
  Picture point;
  point.meshes.push_back(
      {.triangles = {{0, 0, 0}}, .positions = {1, 2, 3}, .fabric_coordinates = {}, .look = {}});
  draw_with_mock(point);
  Picture from_above = make_still_life();
  from_above.light.to_sun = Vec3::UnitY();
  from_above.camera.elevation_deg = 89;
  draw_with_mock(from_above);
}

TEST(Renderer, ShowsInsteadOfReadingInAWindow) {
  auto device = std::make_unique<MockDevice>();
  const MockDevice& mock = *device;
  Renderer renderer(std::move(device));
  renderer.show(make_still_life(), {64, 64}, {0, 0, {64, 64}});
  EXPECT_EQ(mock.log().back(), "show picture");
}

TEST(Normals, PointAwayFromTheFrontAndAreUnit) {
  const DrawnMesh sheet = make_sheet({0, 0, 0}, 1, fabric({1, 1, 1}));
  const std::vector<float> normals = compute_vertex_normals(sheet.triangles, sheet.positions);
  ASSERT_EQ(normals.size(), sheet.positions.size());
  const float up = normals[1];
  EXPECT_NEAR(std::abs(up), 1, 1e-6);
  for (std::size_t v = 0; v < normals.size() / 3; ++v) EXPECT_NEAR(normals[3 * v + 1], up, 1e-6);
}

TEST(MockDevice, RefusesWhatOpenGlWouldGetWrong) {
  MockDevice device;
  EXPECT_THROW(device.upload(std::vector<float>(9), std::vector<Triangle>{{0, 0, 1}}), std::logic_error);
  EXPECT_THROW(device.upload(std::vector<float>(8), {}), std::logic_error);
  const TargetId depth = device.target("depth", {TargetDesc::Format::depth, 8, 8});
  const TargetId color = device.target("colour", {TargetDesc::Format::color, 8, 8, 4});
  const GeometryId point = device.upload(std::vector<float>(9), std::vector<Triangle>{{0, 0, 0}});
  EXPECT_THROW(
      device.draw({Program::depth, {{"to_clip", Eigen::Matrix4f(Eigen::Matrix4f::Identity())}}, point}),
      std::logic_error)
      << "outside a pass";
  device.begin_pass(depth);
  EXPECT_THROW(device.draw({Program::depth, {}, point}), std::logic_error) << "a uniform is missing";
  EXPECT_THROW(device.draw({Program::depth, {{"to_clip", 1.0f}}, point}), std::logic_error) << "another type";
  EXPECT_THROW(device.read(color), std::logic_error) << "several samples";
}

}  // namespace
}  // namespace weft::engine
