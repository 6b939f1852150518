// Successful tests leave their files in WEFT_OUTPUT_DIR, for the Khronos validator (glb_validator_test.sh).

#include "weft/io/glb_writer.h"

#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "tests/own_folder.h"
#include "weft/error.h"
#include "weft/mesh/grid.h"

namespace weft::engine {
namespace {

constexpr Grid kGrid{.size_x = 1, .size_z = 2, .cells_x = 6, .cells_z = 8};

/// A cloth that waves, turns and travels.
AnimatedCloth make_flag(int num_frames) {
  const TriangleMesh grid = build_grid_mesh(kGrid, GridDiagonals::alternating);
  AnimatedCloth flag{.name = "flag", .triangles = grid.triangles, .color = {0.8, 0.1, 0.1}, .frames = {}};
  for (int k = 0; k < num_frames; ++k) {
    auto& frame = flag.frames.emplace_back();
    for (const Vec3& x : grid.positions) {
      const Vec3 moved(x.x() + 0.01 * k, 0.1 * std::sin(5 * x.x() + 0.7 * k), x.z() * (1 - 0.02 * k));
      for (const double coordinate : moved) frame.push_back(static_cast<float>(coordinate));
    }
  }
  return flag;
}

AnimatedBody make_ball(int num_poses) {
  AnimatedBody ball{
      .name = "ball", .mesh = make_sphere_mesh({0, 0, 0}, 0.3, 6), .color = {0.2, 0.4, 0.9}, .poses = {}};
  for (int k = 0; k < num_poses; ++k) {
    ball.poses.push_back(
        {Vec3(0.1 * k, 1, 0), Eigen::Quaterniond(Eigen::AngleAxisd(0.2 * k, Vec3::UnitZ()))});
  }
  return ball;
}

std::string output_file(const std::string& name) {
  std::filesystem::create_directories(WEFT_OUTPUT_DIR);
  return std::string(WEFT_OUTPUT_DIR) + "/" + name + ".glb";
}

tinygltf::Model read(const std::string& file) {
  tinygltf::Model model;
  std::string error, warning;
  EXPECT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &error, &warning, file)) << error;
  EXPECT_EQ(error + warning, "");
  return model;
}

tinygltf::Model write_and_read(const std::string& name, const Animation& animation) {
  const std::string file = output_file(name);
  write_glb(file, animation);
  return read(file);
}

std::vector<float> floats(const tinygltf::Model& model, int accessor_index) {
  const tinygltf::Accessor& accessor = model.accessors[accessor_index];
  const tinygltf::BufferView& view = model.bufferViews[accessor.bufferView];
  std::vector<float> result(accessor.count * tinygltf::GetNumComponentsInType(accessor.type));
  const auto* begin = model.buffers[0].data.data() + view.byteOffset + accessor.byteOffset;
  std::memcpy(result.data(), begin, result.size() * sizeof(float));
  return result;
}

const tinygltf::Primitive& primitive(const tinygltf::Model& model, int mesh) {
  return model.meshes[mesh].primitives[0];
}

/// The base plus the weighted targets, as a viewer blends them.
std::vector<float> blend(const tinygltf::Model& model, const char* attribute,
                         const std::vector<float>& weights) {
  std::vector<float> result = floats(model, primitive(model, 0).attributes.at(attribute));
  for (size_t k = 0; k < weights.size(); ++k) {
    const auto delta = floats(model, primitive(model, 0).targets[k].at(attribute));
    for (size_t i = 0; i < result.size(); ++i) result[i] += weights[k] * delta[i];
  }
  return result;
}

TEST(GlbWriter, GivesEveryFrameBackToRoundOff) {
  const int num_frames = 5;
  const AnimatedCloth flag = make_flag(num_frames);
  const auto model =
      write_and_read("frames", {.title = "", .frames_per_second = 25, .cloths = {flag}, .bodies = {}});
  ASSERT_EQ(model.animations.size(), 1u);
  const tinygltf::AnimationSampler& sampler = model.animations[0].samplers[0];
  EXPECT_EQ(model.animations[0].channels[0].target_path, "weights");
  EXPECT_EQ(sampler.interpolation, "LINEAR");
  const auto times = floats(model, sampler.input);
  const auto weights = floats(model, sampler.output);
  ASSERT_EQ(times.size(), 5u);
  ASSERT_EQ(weights.size(), 20u);
  for (int k = 0; k < num_frames; ++k) {
    EXPECT_FLOAT_EQ(times[k], static_cast<float>(k) / 25);
    const auto* begin = weights.data() + 4 * k;
    const auto positions = blend(model, "POSITION", {begin, begin + 4});
    ASSERT_EQ(positions.size(), flag.frames[k].size());
    // base + (frame - base): two roundings of numbers up to 2
    for (size_t i = 0; i < positions.size(); ++i) EXPECT_NEAR(positions[i], flag.frames[k][i], 3e-7);
  }
}

TEST(GlbWriter, BlendsUnitNormalsThatFollowTheCloth) {
  const AnimatedCloth flag = make_flag(3);
  const auto model = write_and_read("normals", {.title = "", .cloths = {flag}, .bodies = {}});
  const auto normals = blend(model, "NORMAL", {0, 1});
  for (size_t v = 0; v < normals.size(); v += 3) {
    const Vec3 normal(normals[v], normals[v + 1], normals[v + 2]);
    EXPECT_NEAR(normal.norm(), 1, 1e-6);
    // The surface y = 0.1 sin(5 s + 1.4); the normals of the coarse grid approximate those of the surface.
    const double slope = 0.5 * std::cos(5 * (flag.frames[2][v] - 0.02) + 1.4);
    const double cosine = std::abs(normal.dot(Vec3(-slope, 1, 0).normalized()));
    EXPECT_GT(cosine, 0.97);
  }
}

TEST(GlbWriter, TellsTheBoundsOfThePositions) {
  const auto model = write_and_read("bounds", {.title = "", .cloths = {make_flag(2)}, .bodies = {}});
  const tinygltf::Accessor& base = model.accessors[primitive(model, 0).attributes.at("POSITION")];
  ASSERT_EQ(base.minValues.size(), 3u);
  ASSERT_EQ(base.maxValues.size(), 3u);
  EXPECT_EQ(base.minValues[0], 0);
  EXPECT_EQ(base.maxValues[0], 1);
  EXPECT_EQ(base.maxValues[2], 2);
  EXPECT_EQ(model.accessors[primitive(model, 0).targets[0].at("POSITION")].minValues.size(), 3u);
}

TEST(GlbWriter, WritesASingleFrameWithoutAnimation) {
  const auto model =
      write_and_read("still", {.title = "A still", .cloths = {make_flag(1)}, .bodies = {make_ball(1)}});
  EXPECT_TRUE(model.animations.empty());
  EXPECT_TRUE(primitive(model, 0).targets.empty());
  EXPECT_EQ(model.nodes.size(), 2u);
  EXPECT_EQ(model.asset.generator, "Weft");
  EXPECT_EQ(model.asset.extras.Get("title").Get<std::string>(), "A still");
}

TEST(GlbWriter, MovesBodiesByTheirPoses) {
  const auto model = write_and_read(
      "bodies", {.title = "", .cloths = {make_flag(4)}, .bodies = {make_ball(4), make_ball(1)}});
  const tinygltf::Animation& motion = model.animations[0];
  ASSERT_EQ(motion.channels.size(), 3u);  // the weights, and two of the moving ball
  EXPECT_EQ(motion.channels[1].target_path, "translation");
  EXPECT_EQ(motion.channels[2].target_path, "rotation");
  EXPECT_EQ(motion.channels[2].target_node, 1);
  const auto translations = floats(model, motion.samplers[motion.channels[1].sampler].output);
  const auto rotations = floats(model, motion.samplers[motion.channels[2].sampler].output);
  ASSERT_EQ(rotations.size(), 16u);
  EXPECT_FLOAT_EQ(translations[9], 0.3f);
  EXPECT_FLOAT_EQ(rotations[14], std::sin(0.3f));  // z of x y z w at frame 3, half of 0.6 rad
  EXPECT_FLOAT_EQ(rotations[15], std::cos(0.3f));
}

TEST(GlbWriter, WritesBodiesWithoutCloth) {
  const auto model = write_and_read("no_cloth", {.title = "", .cloths = {}, .bodies = {make_ball(3)}});
  EXPECT_EQ(model.animations[0].channels.size(), 2u);
}

TEST(GlbWriter, GivesVerticesWithoutAreaAUnitNormal) {
  AnimatedCloth cloth{.name = "flat", .triangles = {{0, 1, 2}, {0, 0, 3}}, .color = {1, 1, 1}, .frames = {}};
  cloth.frames = {{0, 0, 0, 1, 0, 0, 2, 0, 0, 5, 5, 5}, {0, 0, 0, 1, 0, 0, 2, 1, 0, 5, 5, 5}};
  const auto model = write_and_read("no_area", {.title = "", .cloths = {cloth}, .bodies = {}});
  const auto normals = floats(model, primitive(model, 0).attributes.at("NORMAL"));
  for (size_t v = 0; v < normals.size(); v += 3) {
    EXPECT_FLOAT_EQ(std::hypot(normals[v], normals[v + 1], normals[v + 2]), 1.0f);
  }
}

TEST(GlbWriter, MakesDoubleSidedMattMaterials) {
  const auto model = write_and_read("materials", {.title = "", .cloths = {make_flag(1)}, .bodies = {}});
  const tinygltf::Material& material = model.materials[primitive(model, 0).material];
  EXPECT_TRUE(material.doubleSided);
  EXPECT_EQ(material.pbrMetallicRoughness.metallicFactor, 0);
  EXPECT_EQ(material.pbrMetallicRoughness.baseColorFactor, (std::vector<double>{0.8, 0.1, 0.1, 1}));
}

TEST(GlbWriter, ReplacesAnEarlierFileAndLeavesNoOther) {
  const std::filesystem::path folder = make_own_folder();
  write_glb(folder / "a.glb", {.title = "", .cloths = {make_flag(4)}, .bodies = {}});
  write_glb(folder / "a.glb", {.title = "", .cloths = {make_flag(1)}, .bodies = {}});
  EXPECT_TRUE(read((folder / "a.glb").string()).animations.empty());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
}

TEST(GlbWriter, TellsWhyAFileCannotBeWritten) {
  const Animation animation{.title = "", .cloths = {make_flag(1)}, .bodies = {}};
  const std::filesystem::path folder = make_own_folder() / "folder.glb";
  std::filesystem::create_directories(folder / "occupied");
  EXPECT_THROW(write_glb(folder, animation), InputError);  // a folder has this name
  EXPECT_FALSE(std::filesystem::exists(folder.parent_path() / ".folder.glb.partial"));
  try {
    write_glb(folder / "missing" / "a.glb", animation);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("No such file"), std::string::npos) << error.what();
  }
}

TEST(GlbWriter, RefusesAnimationsThatNoViewerCouldShow) {
  const auto refuses = [](const Animation& animation) {
    EXPECT_THROW(write_glb(make_own_folder() / "refused.glb", animation), InputError);
  };
  refuses({});
  refuses({.title = "", .cloths = {make_flag(2), make_flag(3)}, .bodies = {}});
  refuses({.title = "", .cloths = {make_flag(2)}, .bodies = {make_ball(3)}});
  refuses({.title = "", .cloths = {make_flag(0)}, .bodies = {}});
  refuses({.title = "", .frames_per_second = 0, .cloths = {make_flag(2)}, .bodies = {}});
  AnimatedCloth broken = make_flag(2);
  broken.frames[1][7] = std::numeric_limits<float>::quiet_NaN();
  refuses({.title = "", .cloths = {broken}, .bodies = {}});
  AnimatedCloth torn = make_flag(2);
  torn.triangles[0][1] = 1000;
  refuses({.title = "", .cloths = {torn}, .bodies = {}});
}

/// Size of a file of so many frames of a waving flag and two balls [bytes].
double size_of(int num_frames) {
  Animation animation{.title = "", .cloths = {make_flag(num_frames)}, .bodies = {make_ball(num_frames)}};
  animation.bodies.push_back(make_ball(1));
  const std::string file = output_file("size");
  write_glb(file, animation);
  return static_cast<double>(std::filesystem::file_size(file));
}

TEST(GlbWriter, KnowsHowManyFramesThereIsRoomFor) {
  // Extrapolated by the parabola through three sizes: the full file is below 4 GiB, and not far below.
  const double at_100 = size_of(100), at_200 = size_of(200), at_300 = size_of(300);
  StagedFile file(output_file("room"));
  GlbWriter writer(file, {.cloths = {make_flag(1)}, .bodies = {make_ball(1), make_ball(1)}});
  writer.add_frame(get_frame({.cloths = {make_flag(1)}, .bodies = {make_ball(1), make_ball(1)}}, 0));
  const double frames = static_cast<double>(writer.max_frames()), x = frames / 100 - 1;
  const double size = at_100 + (at_200 - at_100) * x + (at_300 - 2 * at_200 + at_100) * x * (x - 1) / 2;
  EXPECT_LT(size, 4294967296.0) << frames << " frames";
  EXPECT_GT(size, 0.6 * 4294967296.0) << frames << " frames";
}

}  // namespace
}  // namespace weft::engine
