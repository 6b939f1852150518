#include "weft/pictures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "weft/face/world_impl.h"
#include "weft/io/glb_writer.h"
#include "weft/run/film.h"
#include "weft/weft.h"

namespace weft {
namespace {

const RenderOptions kWithoutColor = {.color = false};

/// A horizontal sheet of a metre around a point.
ClothId add_sheet(World& world, const Vec3& center) {
  return world.add_cloth({.shape = Grid{.size_x = 1, .size_z = 1, .cells_x = 8, .cells_z = 8},
                          .fabric = find_fabric("denim"),
                          .pose = {.translation = center - Vec3{0.5, 0, 0.5}}});
}

double focal_length(const Camera& camera) {
  return camera.height / (2 * std::tan(camera.fov_deg * std::numbers::pi / 360));
}

/// A sheet over a ball, and a level plane below.
World make_world() {
  World world;
  add_sheet(world, {0, 0.5, 0});
  world.add_collider({.shape = Sphere{.center = {0, 0.2, 0}, .radius = 0.2}});
  world.add_collider({.shape = Plane{.point = {0, -0.1, 0}}});
  return world;
}

TEST(Pictures, ABallHasItsExactDepthAndItsIdInTheMiddle) {
  World world;
  add_sheet(world, {0, -5, 0});
  world.add_collider({.shape = Plane{.point = {0, -9, 0}}});
  world.add_collider({.shape = Sphere{.center = {0, 0, 0}, .radius = 0.5}});
  const Camera camera{.position = {0, 0, 3}, .width = 65, .height = 65};
  const Rendering picture = OffscreenRenderer().render(world, camera, kWithoutColor);
  const std::size_t middle = 32 * 65 + 32;
  EXPECT_FLOAT_EQ(picture.depth[middle], 2.5f);
  EXPECT_EQ(picture.ids[middle], 1 + 1) << "after one cloth, the second collider";
  EXPECT_EQ(picture.ids[0], -1) << "above the horizon";
  EXPECT_EQ(picture.depth[0], std::numeric_limits<float>::infinity());
  EXPECT_TRUE(picture.rgb.empty());
}

TEST(Pictures, ASheetCoversItsProjectedArea) {
  World world;
  add_sheet(world, {0, 0, 0});
  const Camera camera{.position = {0, 2, 0}, .fov_deg = 40, .width = 400, .height = 400};
  const Rendering picture = OffscreenRenderer().render(world, camera, kWithoutColor);
  const double side = focal_length(camera) / 2;  // a metre at a distance of 2 m
  const auto count = std::count(picture.ids.begin(), picture.ids.end(), 0);
  EXPECT_NEAR(static_cast<double>(count), side * side, 0.01 * side * side) << "whole pixels";
}

TEST(Pictures, SeenFromAboveTheUpperBorderIsTowardsMinusZ) {
  World world;
  add_sheet(world, {1, 0, -1});
  const Camera camera{.position = {0, 5, 0}, .width = 100, .height = 100};
  const Rendering picture = OffscreenRenderer().render(world, camera, kWithoutColor);
  const double per_metre = focal_length(camera) / 5;
  const int column = static_cast<int>(50 + per_metre), row = static_cast<int>(50 - per_metre);
  EXPECT_EQ(picture.ids[static_cast<std::size_t>(100 * row + column)], 0);
  EXPECT_EQ(picture.ids[static_cast<std::size_t>(100 * column + row)], -1);
}

TEST(Pictures, ALevelPlaneIsEndless) {
  const World world = make_world();
  const Camera camera{.position = {0, 1.9, 100}, .target = {0, -0.1, 80}, .width = 65, .height = 65};
  const Rendering picture = OffscreenRenderer().render(world, camera, kWithoutColor);
  const std::size_t middle = 32 * 65 + 32;
  EXPECT_EQ(picture.ids[middle], 1 + 1);
  EXPECT_NEAR(picture.depth[middle], std::hypot(2, 20), 1e-5) << "floats";
}

TEST(Pictures, AFramedWorldFillsThePicture) {
  const World world = make_world();
  for (const Camera& like :
       {Camera{}, Camera{.position = {-3, 0.2, 1}, .fov_deg = 70, .width = 300, .height = 900},
        Camera{.position = {0, 4, 0}}}) {
    const Camera camera = frame_camera(world, like);
    // Along the viewing direction, and the distance from it as a share of the way to the picture's border.
    const Vec3 way = camera.target - camera.position;
    const Vec3 forward = (1 / length(way)) * way;
    const bool is_vertical = std::abs(forward.y) > 0.999;
    const Vec3 side = is_vertical ? Vec3{1, 0, 0} : cross(forward, {0, 1, 0});
    const Vec3 right = (1 / length(side)) * side, up = cross(right, forward);
    double largest = 0;
    for (const Vec3& p : world.positions(world.cloth(0))) {
      const Vec3 d = p - camera.position;
      const double scale = focal_length(camera) / dot(d, forward);
      EXPECT_GT(scale, 0);
      largest = std::max({largest, std::abs(scale * dot(d, right)) / (0.5 * camera.width),
                          std::abs(scale * dot(d, up)) / (0.5 * camera.height)});
    }
    EXPECT_LT(largest, 1);
    EXPECT_GT(largest, 0.7) << "the sheet is the largest thing";
    EXPECT_EQ(camera.width, like.width);
    EXPECT_EQ(camera.fov_deg, like.fov_deg);
  }
}

TEST(Pictures, ShowTheClothInItsColor) {
  const World world = make_world();
  const Camera camera{.position = {0, 3, 0}, .target = {0, 0.5, 0}, .width = 64, .height = 48};
  OffscreenRenderer renderer;
  try {
    for (const int shown : {0, 1, 2}) {
      std::array<double, 3> color = {0.02, 0.02, 0.02};
      color[shown] = 0.6;
      const Rendering picture = renderer.render(world, camera, {.cloth_colors = {color}});
      ASSERT_EQ(picture.rgb.size(), 3u * 64 * 48);
      const std::uint8_t* middle = &picture.rgb[3 * (24 * 64 + 32)];
      for (const int other : {(shown + 1) % 3, (shown + 2) % 3})
        EXPECT_GT(middle[shown], 1.5 * middle[other]);
      EXPECT_EQ(picture.ids[24 * 64 + 32], 0);
    }
  } catch (const GraphicsError& error) {
    GTEST_SKIP() << error.what();
  }
}

TEST(Pictures, ARecordingLooksLikeItsWorld) {
  World world = make_world();
  const engine::World& inner = WorldAccess::engine(world);
  engine::Animation animation = engine::make_animation(inner);
  engine::append_frame(engine::capture_frame(inner), animation);
  for (int step = 0; step < 10; ++step) world.step(1.0 / 60);
  engine::append_frame(engine::capture_frame(inner), animation);
  std::filesystem::create_directories(WEFT_OUTPUT_DIR);
  engine::write_glb(WEFT_OUTPUT_DIR "/recording.glb", animation);

  const Recording recording(WEFT_OUTPUT_DIR "/recording.glb");
  EXPECT_EQ(recording.num_frames(), 2);
  EXPECT_EQ(recording.num_cloths(), 1);
  const Camera camera = frame_camera(recording, {.width = 160, .height = 120}),
               near = frame_camera(world, camera);
  const Vec3 back = camera.position - camera.target;
  EXPECT_GE(dot(camera.position, back), dot(near.position, back) - 1e-6) << "all frames share a camera";
  OffscreenRenderer renderer;
  const Rendering recorded = renderer.render(recording, 1, camera, kWithoutColor),
                  now = renderer.render(world, camera, kWithoutColor);
  int different = 0;
  for (std::size_t pixel = 0; pixel < now.ids.size(); ++pixel) {
    if (recorded.ids[pixel] != now.ids[pixel]) {
      ++different;
    } else if (now.ids[pixel] >= 0 && now.depth[pixel] < 10) {
      EXPECT_NEAR(recorded.depth[pixel], now.depth[pixel], 1e-4) << "floats, at grazing angles too";
    }
  }
  EXPECT_LE(different, 10) << "outlines, by rounding to floats";
  EXPECT_THROW(renderer.render(recording, 2, camera), InputError);
  EXPECT_THROW(renderer.render(recording, -1, camera), InputError);
  EXPECT_THROW(write_video(WEFT_OUTPUT_DIR "/video.avi", recording, camera), InputError);
  EXPECT_THROW(write_video(WEFT_OUTPUT_DIR "/video.mp4", recording, camera, {}, 0), InputError);
}

TEST(Pictures, InvalidInputIsRefused) {
  const World world = make_world();
  OffscreenRenderer renderer;
  for (const Camera& camera :
       {Camera{.position = {1, 1, 1}, .target = {1, 1, 1}}, Camera{.position = {NAN, 0, 0}},
        Camera{.fov_deg = 0}, Camera{.fov_deg = 180}, Camera{.width = 0}, Camera{.height = 100'000}}) {
    EXPECT_THROW(renderer.render(world, camera), InputError);
    EXPECT_THROW(frame_camera(world, camera), InputError);
  }
  for (const RenderOptions& options :
       {RenderOptions{.samples = 0}, RenderOptions{.cloth_colors = {{0, 0, 0}, {1, 1, 1}}},
        RenderOptions{.cloth_colors = {{0, 0, 255}}}, RenderOptions{.ground = NAN}})
    EXPECT_THROW(renderer.render(world, {}, options), InputError);
  const Rendering without_rgb = renderer.render(world, {}, kWithoutColor);
  EXPECT_THROW(write_picture(WEFT_OUTPUT_DIR "/picture.png", without_rgb), InputError);
  EXPECT_THROW(write_picture(WEFT_OUTPUT_DIR "/picture.bmp", without_rgb), InputError);
}

TEST(Pictures, WithoutADriverColorsThrowAndDepthsDoNot) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // a new process: EGL loads its drivers once
  EXPECT_EXIT(
      {
        setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/dev/null", 1);
        const World world = make_world();
        OffscreenRenderer renderer;
        const bool has_depths = !renderer.render(world, {}, kWithoutColor).depth.empty();
        try {
          renderer.render(world, {});
        } catch (const GraphicsError&) {
          std::exit(has_depths ? 0 : 2);
        }
        std::exit(1);
      },
      testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace weft
