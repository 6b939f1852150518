/// OpenGL rendering: tests of single pixels, and one whole picture. Drivers differ in rounding and filtering,
/// so colours are compared with a tolerance of a few steps of 255.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/render/pictures.h"
#include "weft/mesh/grid.h"
#include "weft/render/depth_picture.h"
#include "weft/render/renderer.h"

namespace weft::engine {
namespace {

class Offscreen : public testing::Test {
 protected:
  void SetUp() override {
    try {
      renderer_ = std::make_unique<Renderer>(make_offscreen_device());
    } catch (const GraphicsError& error) {
      GTEST_SKIP() << error.what();
    }
  }

  Image picture_of(const Picture& picture, PictureSize size = {160, 120}) {
    return renderer_->draw(picture, size);
  }

  std::unique_ptr<Renderer> renderer_;
};

int red(const Image& image, int x, int y) { return image.pixel(x, y)[0]; }
int green(const Image& image, int x, int y) { return image.pixel(x, y)[1]; }
int alpha(const Image& image, int x, int y) { return image.pixel(x, y)[3]; }

/// View from straight above, north up, `half` metres from the centre to the upper border.
Camera from_above(double half) {
  return {.target = Vec3::Zero(),
          .distance = half / std::tan(0.08726646),
          .azimuth_deg = 0,
          .elevation_deg = 89,
          .fov_deg = 10};
}

TEST_F(Offscreen, DrawsWhatIsThereAndNothingElse) {
  Picture picture;
  picture.transparent = true;
  picture.camera = from_above(1);
  picture.meshes.push_back(make_sheet({0, 0, 0}, 1, fabric({0.8, 0.02, 0.02})));
  const Image image = picture_of(picture);
  EXPECT_EQ(alpha(image, 80, 60), 255);
  EXPECT_EQ(alpha(image, 5, 5), 0);
  EXPECT_GT(red(image, 80, 60), 3 * green(image, 80, 60));
  // The sheet's half side is half of the picture's half height: 30 pixels.
  for (const int out : {-33, 33}) EXPECT_EQ(alpha(image, 80 + out, 60), 0) << out;
  for (const int in : {-27, 27}) EXPECT_EQ(alpha(image, 80 + in, 60), 255) << in;
}

TEST_F(Offscreen, LightsClothFromBothSides) {
  Picture picture;
  picture.transparent = true;
  picture.meshes.push_back(make_sheet({0, 0, 0}, 1, fabric({0.5, 0.5, 0.5})));
  picture.camera.elevation_deg = 60;
  const int above = green(picture_of(picture), 80, 60);
  picture.camera.elevation_deg = -60;
  const int below = green(picture_of(picture), 80, 60);
  EXPECT_GT(above, below) << "the sun shines on the upper side";
  EXPECT_GT(below, 60) << "the ground's light and some of the sun's come to the lower one";
  for (Triangle& t : picture.meshes[0].triangles) std::swap(t[1], t[2]);
  EXPECT_NEAR(green(picture_of(picture), 80, 60), below, 3) << "which side is the front makes no difference";
}

TEST_F(Offscreen, ShadowsFallAwayFromTheSunAndAreSofterFartherAway) {
  Picture picture;
  picture.camera = from_above(0.6);
  picture.light.to_sun = Vec3(-1, 1, 0).normalized();  // from the left
  picture.ground = 0;
  picture.meshes.push_back(make_sheet({-0.4, 0.4, 0}, 0.3, fabric({0.5, 0.5, 0.5})));
  const PictureSize size{480, 480};  // 400 pixels a metre
  const Image image = picture_of(picture, size);
  const int lit = green(image, 440, 60), dark = green(image, 240, 240);
  EXPECT_LT(dark, 0.75 * lit) << "the shadow's middle is at the origin";
  EXPECT_NEAR(green(image, 60, 440), lit, 4) << "nothing casts a shadow there";
  const auto width_of_edge = [&](const Image& shadow, int x) {
    int between = 0;
    for (int y = 240; y < 480; ++y) {
      const int g = green(shadow, x, y);
      between += g > dark + 0.15 * (lit - dark) && g < lit - 0.15 * (lit - dark);
    }
    return between;
  };
  const int high = width_of_edge(image, 280);
  picture.meshes[0] = make_sheet({-0.1, 0.1, 0}, 0.3, fabric({0.5, 0.5, 0.5}));
  const int low = width_of_edge(picture_of(picture, size), 280);
  EXPECT_GT(high, 2 * low) << "four times as high";
  EXPECT_GT(low, 0);
}

TEST_F(Offscreen, OcclusionDarkensCorners) {
  Picture picture;
  picture.light.sun = {0, 0, 0};
  picture.ground = 0;
  picture.camera.target = {0, 0.2, 0};
  picture.meshes.push_back(
      draw(make_box_mesh({0, 0.5, -0.5}, {1, 0.5, 0.1}, Mat3::Identity()), solid({0.5, 0.5, 0.5})));
  Renderer plain(make_offscreen_device(), {.occlusion = false});
  const Image with = picture_of(picture, {320, 240}), without = plain.draw(picture, {320, 240});
  int darker = 0, lighter = 0;
  for (int y = 0; y < 240; ++y) {
    darker += green(with, 160, y) < green(without, 160, y) - 8;
    lighter += green(with, 160, y) > green(without, 160, y) + 3;
  }
  EXPECT_GT(darker, 5) << "along the foot of the wall";
  EXPECT_LT(darker, 100) << "and not everywhere";
  EXPECT_EQ(lighter, 0);
}

TEST_F(Offscreen, ChecksFollowTheClothAsItStretches) {
  const auto changes_across = [&](double stretch) {
    Picture picture;
    picture.transparent = true;
    picture.camera = from_above(1);
    picture.meshes.push_back(make_sheet({0, 0, 0}, 1, fabric({0.6, 0.1, 0.1}, 0.1)));
    for (std::size_t i = 0; i < picture.meshes[0].positions.size(); i += 3)
      picture.meshes[0].positions[i] *= static_cast<float>(stretch);
    const Image image = picture_of(picture, {480, 240});
    int changes = 0;
    for (int x = 180; x < 300; ++x)
      changes += std::abs(green(image, x, 122) - green(image, x - 2, 122)) > 20 &&
                 std::abs(green(image, x - 1, 122) - green(image, x - 3, 122)) <= 20;
    return changes;
  };
  const int at_rest = changes_across(1), stretched = changes_across(2);
  EXPECT_NEAR(at_rest, 10, 2) << "120 pixels are a metre, a check is 0.1 m";
  EXPECT_NEAR(stretched, 5, 2);
}

/// A sheet in waves along x, a metre on a side, whose slopes come close to the sun's direction.
DrawnMesh make_waves() {
  DrawnMesh sheet;
  const TriangleMesh flat =
      build_grid_mesh({.size_x = 1, .size_z = 1, .cells_x = 40, .cells_z = 40}, GridDiagonals::alternating);
  sheet.triangles = flat.triangles;
  sheet.look = fabric({0.5, 0.5, 0.5});
  for (const Vec3& p : flat.positions) {
    for (const double c : {p.x() - 0.5, 0.06 * std::sin(30 * p.x()), p.z() - 0.5})
      sheet.positions.push_back(static_cast<float>(c));
  }
  return sheet;
}

TEST_F(Offscreen, GrazingLightLeavesNoDots) {
  Picture picture;
  picture.transparent = true;
  picture.camera = from_above(0.8);
  picture.light.to_sun = Vec3(-1.4, 1, 0.1).normalized();
  picture.meshes.push_back(make_waves());
  const PictureSize size{400, 400};
  const Image image = picture_of(picture, size);
  int dots = 0, darkest = 255, brightest = 0;
  for (int y = 90; y < 310; ++y) {
    for (int x = 90; x < 310; ++x) {
      const int here = green(image, x, y);
      const std::array around = {green(image, x - 2, y), green(image, x + 2, y), green(image, x, y - 2),
                                 green(image, x, y + 2)};
      const auto [least, most] = std::minmax_element(around.begin(), around.end());
      dots += here < *least - 10 || here > *most + 10;
      darkest = std::min(darkest, here);
      brightest = std::max(brightest, here);
    }
  }
  EXPECT_LE(dots, 25) << "of 48400 pixels";
  EXPECT_GT(brightest, darkest + 60) << "the waves shade each other";
}

TEST_F(Offscreen, OcclusionStopsAtOutlines) {
  Picture picture;
  picture.transparent = true;
  picture.camera.elevation_deg = 0;
  picture.camera.azimuth_deg = 0;
  picture.meshes.push_back(draw(make_sphere_mesh(Vec3::Zero(), 0.3, 32), solid({0.6, 0.6, 0.6})));
  picture.meshes.push_back(
      draw(make_box_mesh({0, 0, -1.2}, {2, 2, 0.1}, Mat3::Identity()), solid({0.6, 0.6, 0.6})));
  picture.camera.distance = 2;
  Renderer plain(make_offscreen_device(), {.shadow_size = 0, .occlusion = false}),
      occluded(make_offscreen_device(), {.shadow_size = 0});
  const PictureSize size{320, 240};
  const Image with = occluded.draw(picture, size), without = plain.draw(picture, size);
  const DepthPicture depths = draw_depths(picture.meshes, {}, picture.camera, size);
  int wall = 0, darker = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      if (depths.index[static_cast<std::size_t>(y) * size.width + x] != 1) continue;
      ++wall;
      darker += std::abs(green(with, x, y) - green(without, x, y)) > 4;
    }
  }
  EXPECT_GT(wall, 10000);
  EXPECT_LE(darker, wall / 500) << "pixels that show both";
}

TEST_F(Offscreen, AWeaveIsSeenCloseUpAndFadesWithoutMoire) {
  const auto deviation = [&](double half_height, weft::Weave weave) {
    Picture picture;
    picture.transparent = true;
    picture.camera = from_above(half_height);
    picture.camera.azimuth_deg = 7;
    picture.meshes.push_back(make_sheet(Vec3::Zero(), 1, fabric({0.4, 0.4, 0.4})));
    picture.meshes[0].look.fabric = {.weave = weave, .thread = 1e-3};
    const Image image = picture_of(picture);
    double sum = 0, squares = 0;
    for (int y = 45; y < 75; ++y) {
      for (int x = 65; x < 95; ++x) sum += green(image, x, y), squares += std::pow(green(image, x, y), 2);
    }
    return std::sqrt(std::max(0.0, squares / 900 - std::pow(sum / 900, 2)));
  };
  for (const weft::Weave weave :
       {weft::Weave::plain, weft::Weave::twill, weft::Weave::satin, weft::Weave::knit}) {
    EXPECT_GT(deviation(0.006, weave), 8) << "ten pixels a thread";
    for (const double far : {0.4, 0.5, 0.73, 1.0})
      EXPECT_LT(deviation(far, weave), 1.5) << "six threads a pixel and more: an even colour";
  }
}

TEST_F(Offscreen, ValuesAreShownByTheMapsColours) {
  Picture picture;
  picture.transparent = true;
  picture.camera = from_above(1);
  picture.meshes.push_back(make_sheet(Vec3::Zero(), 1, fabric({0.8, 0.02, 0.02})));
  DrawnMesh& sheet = picture.meshes[0];
  for (std::size_t v = 0; v < sheet.positions.size(); v += 3) sheet.values.push_back(sheet.positions[v]);
  sheet.range = {-0.5, 0.5};
  const Image image = picture_of(picture);
  const auto channel = [&](int x, int c) { return static_cast<int>(image.pixel(x, 60)[c]); };
  EXPECT_GT(channel(53, 2), 1.5 * channel(53, 1)) << "violet at the lower end";
  EXPECT_GT(channel(80, 1), 1.3 * channel(80, 0)) << "green in the middle";
  EXPECT_GT(channel(107, 0), 1.5 * channel(107, 2)) << "yellow at the upper end";
  sheet.range = {5, 6};
  const Image below = picture_of(picture);
  for (const int x : {60, 80, 100})
    EXPECT_NEAR(below.pixel(x, 60)[1], below.pixel(80, 60)[1], 2) << "beyond the range: its end's colour";
}

TEST_F(Offscreen, CoversThePixelsThatItsTrianglesCover) {
  Picture picture = make_still_life();
  picture.transparent = true;
  picture.lines.clear();
  picture.dots.clear();
  const PictureSize size{480, 270};
  const Image image = picture_of(picture, size);
  const DepthPicture depths = draw_depths(picture.meshes, {}, picture.camera, size);
  int different = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const bool is_covered = depths.index[static_cast<std::size_t>(y) * size.width + x] >= 0;
      different += alpha(image, x, y) != (is_covered ? 255 : 0) && std::abs(alpha(image, x, y) - 128) > 100;
    }
  }
  EXPECT_LE(different, 480 * 270 / 200) << "0.5 % of the picture";
}

TEST_F(Offscreen, EdgesHaveNoSteps) {
  Picture picture;
  picture.transparent = true;
  picture.camera = from_above(1);
  picture.camera.azimuth_deg = 10;  // the sheet's border is slanted in the picture
  picture.meshes.push_back(make_sheet({0, 0, 0}, 1, fabric({0.8, 0.8, 0.8})));
  const auto num_between = [](const Image& image) {
    int between = 0;
    for (int x = 0; x < image.width; ++x) {
      for (int y = 0; y < image.height; ++y) between += alpha(image, x, y) > 0 && alpha(image, x, y) < 255;
    }
    return between;
  };
  EXPECT_GT(num_between(picture_of(picture)), 50);
  Renderer plain(make_offscreen_device(), {.samples = 1});
  EXPECT_EQ(num_between(plain.draw(picture, {160, 120})), 0);
}

TEST_F(Offscreen, ColoursAtEdgesAreNotDarkenedByTheNothingBehind) {
  Picture picture;
  picture.transparent = true;
  picture.camera = from_above(1);
  picture.camera.azimuth_deg = 10;
  picture.meshes.push_back(make_sheet({0, 0, 0}, 1, fabric({0.8, 0.8, 0.8})));
  const Image image = picture_of(picture);
  const int inside = green(image, 80, 60);
  for (int x = 0; x < image.width; ++x) {
    if (alpha(image, x, 60) == 0) continue;
    EXPECT_NEAR(green(image, x, 60), inside, 12) << x;
  }
}

TEST_F(Offscreen, LinesAndDotsHaveTheWidthThatWasAskedFor) {
  Picture picture;
  picture.transparent = true;
  picture.camera = from_above(1);
  picture.lines.push_back({.ends = {{-0.5, 0, 0}, {0.5, 0, 0}}, .color = {0, 0, 1}, .width = 6});
  picture.dots.push_back({.positions = {{0.8, 0, 0}}, .color = {0, 1, 0}, .diameter = 10});
  const Image image = picture_of(picture);
  int line = 0, dot = 0;
  for (int y = 0; y < image.height; ++y) {
    line += alpha(image, 80, y) > 127;
    dot += alpha(image, 80 + 48, y) > 127;
  }
  EXPECT_NEAR(line, 6, 1);
  EXPECT_NEAR(dot, 10, 1);
}

TEST_F(Offscreen, APictureTwiceIsTheSamePicture) {
  const Picture picture = make_still_life();
  EXPECT_EQ(picture_of(picture).rgba, picture_of(picture).rgba);
}

/// Mean difference of colour channels, in steps of 255.
double difference(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += std::abs(a.rgba[i] - b.rgba[i]);
  return sum / static_cast<double>(a.rgba.size());
}

TEST_F(Offscreen, TheStillLifeLooksAsItDid) {
  const std::filesystem::path reference = WEFT_SOURCE_DIR "/tests/render/still_life.png";
  const Image image = picture_of(make_still_life(), {480, 270});
  std::filesystem::create_directories(WEFT_OUTPUT_DIR);
  write_image(WEFT_OUTPUT_DIR "/still_life.png", image);
  // Two drivers differ by less than half a step on average.
  const Image expected = read_png(reference);
  Renderer plain(make_offscreen_device(), {.shadow_size = 0});
  EXPECT_GT(difference(plain.draw(make_still_life(), {480, 270}), expected), 2) << "shadows count";
  EXPECT_LT(difference(image, expected), 2)
      << "look at " << WEFT_OUTPUT_DIR << "/still_life.png, and copy it to " << reference
      << " if it is better";
}

}  // namespace
}  // namespace weft::engine
