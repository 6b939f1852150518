#include "weft/render/depth_picture.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "tests/render/pictures.h"
#include "weft/render/pick.h"

namespace weft::engine {
namespace {

TEST(DepthPicture, IsWhatARayThroughEachPixelHits) {
  Picture picture = make_still_life();
  picture.meshes.push_back(
      draw(make_box_mesh({-0.3, 0.2, 0.5}, {0.1, 0.2, 0.1}, Mat3::Identity()), solid({0.5, 0.5, 0.5})));
  const PictureSize size{64, 48};
  const DepthPicture depths = draw_depths(picture.meshes, {}, picture.camera, size);
  int different = 0, nothing = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const Ray ray = picture.camera.ray(x + 0.5, y + 0.5, size);
      const auto hit = find_first_hit(picture.meshes, ray);
      const std::size_t pixel = static_cast<std::size_t>(y) * size.width + x;
      nothing += !hit;
      if (depths.index[pixel] != (hit ? hit->mesh : -1)) {
        ++different;
      } else if (hit) {
        EXPECT_NEAR(depths.depth[pixel], hit->distance * ray.direction.dot(picture.camera.forward()), 1e-6)
            << "floats; pixel " << x << ", " << y;
      } else {
        EXPECT_EQ(depths.depth[pixel], std::numeric_limits<float>::infinity());
      }
    }
  }
  EXPECT_LE(different, 2) << "rays that graze an outline, by rounding";
  EXPECT_GT(nothing, 100);
  EXPECT_LT(nothing, 64 * 48 - 100);
}

TEST(DepthPicture, TrianglesThatReachBehindTheEyeAreSeenWhereTheyAreInFront) {
  const Camera camera{.target = {0, 0, -1}, .distance = 1, .azimuth_deg = 0, .elevation_deg = 10};
  const PictureSize size{48, 32};
  const std::array square = {draw(make_square_mesh({0, -0.5, 0}, Vec3::UnitY(), 1000), solid({1, 1, 1}))};
  const DepthPicture as_mesh = draw_depths(square, {}, camera, size),
                     as_ground = draw_depths({}, -0.5, camera, size);
  int seen = 0;
  for (std::size_t pixel = 0; pixel < as_mesh.depth.size(); ++pixel) {
    const float depth = as_ground.depth[pixel];
    if (depth > 400) continue;  // beyond the square's border, 500 m away
    EXPECT_NEAR(as_mesh.depth[pixel], depth, 1e-6 * depth);
    EXPECT_EQ(as_mesh.index[pixel], 0);
    ++seen;
  }
  EXPECT_GT(seen, 48 * 32 / 2) << "the horizon is above the picture's middle";
}

TEST(DepthPicture, HasNoGapsBetweenTrianglesThatShareAnEdge) {
  // Vertices and edges of the grid are exactly at pixel centres.
  const std::array sheet = {make_sheet(Vec3::Zero(), 1, fabric({1, 1, 1}))};
  const Camera camera{
      .target = Vec3::Zero(), .distance = 1, .azimuth_deg = 0, .elevation_deg = 90, .fov_deg = 40};
  const DepthPicture depths = draw_depths(sheet, {}, camera, {65, 65});
  for (const float depth : depths.depth) EXPECT_NEAR(depth, 1, 1e-6);
}

}  // namespace
}  // namespace weft::engine
