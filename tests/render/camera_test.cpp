#include "weft/render/camera.h"

#include <gtest/gtest.h>

namespace weft::engine {
namespace {

/// Position of a point in the picture [pixels].
Eigen::Vector2d project(const Camera& camera, const Vec3& p, PictureSize size) {
  const Eigen::Vector4d clip =
      Camera::projection(camera.fov_deg, size.aspect(), 0.01, 100) * camera.view() * p.homogeneous();
  return {(clip.x() / clip.w() + 1) / 2 * size.width, (1 - clip.y() / clip.w()) / 2 * size.height};
}

const Camera kCamera{.target = {0.3, 1.2, -0.4}, .distance = 2.5, .azimuth_deg = 130, .elevation_deg = -25};
const PictureSize kSize{640, 360};

TEST(Camera, SeesItsTargetInTheMiddle) {
  const Eigen::Vector2d middle = project(kCamera, kCamera.target, kSize);
  EXPECT_NEAR(middle.x(), 320, 1e-9);
  EXPECT_NEAR(middle.y(), 180, 1e-9);
  EXPECT_NEAR((kCamera.eye() - kCamera.target).norm(), 2.5, 1e-12);
}

TEST(Camera, RayThroughAPixelHitsWhatIsDrawnThere) {
  for (const Eigen::Vector2d& pixel :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(640, 0), Eigen::Vector2d(123.5, 300.25)}) {
    const Ray ray = kCamera.ray(pixel.x(), pixel.y(), kSize);
    EXPECT_NEAR((project(kCamera, ray.origin + 3.3 * ray.direction, kSize) - pixel).norm(), 0, 1e-8);
    EXPECT_NEAR(ray.direction.norm(), 1, 1e-12);
    const auto back = kCamera.pixel(ray.origin + 0.7 * ray.direction, kSize);
    ASSERT_TRUE(back.has_value());
    EXPECT_NEAR((*back - pixel).norm(), 0, 1e-9);
    EXPECT_FALSE(kCamera.pixel(ray.origin - 0.7 * ray.direction, kSize)) << "behind the eye";
  }
}

TEST(Camera, ElevationLiftsTheEyeAndUpStaysUp) {
  EXPECT_GT(Camera{.elevation_deg = 30}.eye().y(), 0);
  Camera camera = kCamera;
  camera.orbit(400, 1000);  // far beyond the limits
  EXPECT_LT(camera.elevation_deg, 90);
  EXPECT_GT(camera.up().y(), 0);
  camera.orbit(0, -1000);
  EXPECT_GT(camera.elevation_deg, -90);
  EXPECT_GT(camera.up().y(), 0);
}

TEST(Camera, PanMovesTheTargetAcrossThePicture) {
  Camera camera = kCamera;
  camera.pan(0.25, 0);
  const Eigen::Vector2d was = project(camera, kCamera.target, kSize);
  EXPECT_NEAR(was.x(), 320 - 0.25 * 360, 1e-6) << "a quarter of the picture's height to the left";
  EXPECT_NEAR(was.y(), 180, 1e-6);
}

TEST(FramePoints, HoldsAllPointsAndWastesNoRoom) {
  std::vector<Vec3> points;
  for (int k = 0; k < 200; ++k) points.push_back({std::sin(3.0 * k), 0.01 * k, 4 * std::cos(7.0 * k)});
  for (const double azimuth : {0.0, 77.0, 200.0}) {
    for (const PictureSize size : {PictureSize{1280, 720}, PictureSize{300, 700}}) {
      const Camera camera = frame_points({.azimuth_deg = azimuth}, points, size.aspect());
      double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
      for (const Vec3& p : points) {
        const Eigen::Vector2d at = project(camera, p, size);
        left = std::min(left, at.x()), right = std::max(right, at.x());
        top = std::min(top, at.y()), bottom = std::max(bottom, at.y());
      }
      EXPECT_GE(left, 0);
      EXPECT_LE(right, size.width);
      EXPECT_GE(top, 0);
      EXPECT_LE(bottom, size.height);
      const double filled = std::max((right - left) / size.width, (bottom - top) / size.height);
      EXPECT_GT(filled, 0.85) << "one direction is filled but for the margin; perspective costs some of it";
    }
  }
}

TEST(FramePoints, OfOnePointOrNoneIsACamera) {
  EXPECT_GT(frame_points({}, {Vec3(1, 2, 3)}, 1.5).distance, 0);
  EXPECT_EQ(frame_points({.distance = 7}, {}, 1.5).distance, 7);
}

}  // namespace
}  // namespace weft::engine
