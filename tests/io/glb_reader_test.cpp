#include "weft/io/glb_reader.h"

#include "weft/io/glb_writer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <numeric>

#include "tests/own_folder.h"
#include "weft/error.h"
#include "weft/mesh/grid.h"

namespace weft::engine {
namespace {

AnimatedCloth make_cloth(int num_frames) {
  const TriangleMesh grid =
      build_grid_mesh({.size_x = 1, .size_z = 1, .cells_x = 3, .cells_z = 4}, GridDiagonals::alternating);
  AnimatedCloth cloth{.name = "sheet", .triangles = grid.triangles, .color = {0.5, 0.5, 0.5}, .frames = {}};
  for (int k = 0; k < num_frames; ++k) {
    auto& frame = cloth.frames.emplace_back();
    for (const Vec3& x : grid.positions) {
      for (const double coordinate : x) frame.push_back(static_cast<float>(std::sin(coordinate + 0.1 * k)));
    }
  }
  return cloth;
}

AnimatedBody make_body(const std::string& name, std::optional<SolidShape> shape, int num_poses = 1) {
  AnimatedBody body{
      .name = name, .mesh = make_sphere_mesh({0, 0, 0}, 0.3, 6), .color = {0, 0, 1}, .poses = {}};
  body.shape = shape;
  for (int k = 0; k < num_poses; ++k) {
    body.poses.push_back(
        {Vec3(0.1 * k, 1.0 / 3, 0), Eigen::Quaterniond(Eigen::AngleAxisd(0.2 * k, Vec3::UnitZ()))});
  }
  return body;
}

std::string output_file(const std::string& name) {
  std::filesystem::create_directories(WEFT_OUTPUT_DIR);
  return std::string(WEFT_OUTPUT_DIR) + "/" + name + ".glb";
}

Animation write_and_read(const std::string& name, const Animation& animation) {
  write_glb(output_file(name), animation);
  return read_glb(output_file(name));
}

std::string read_bytes(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The error message of read_glb for a file with these bytes.
std::string complaint(const std::string& bytes) {
  const std::string file = (make_own_folder() / "broken.glb").string();
  std::ofstream(file, std::ios::binary) << bytes;
  try {
    read_glb(file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(GlbReader, GivesBackWhatWasWritten) {
  const Animation written{.title = "a run",
                          .frames_per_second = 50,
                          .cloths = {make_cloth(5), make_cloth(5)},
                          .bodies = {make_body("ball", {}, 5), make_body("rock", {})},
                          .passing = {{"sheet", "rock"}}};
  const Animation read = write_and_read("round_trip", written);
  EXPECT_EQ(read.title, "a run");
  EXPECT_EQ(read.passing, written.passing);
  EXPECT_NEAR(read.frames_per_second, 50, 1e-5) << "key times are floats";
  ASSERT_EQ(read.cloths.size(), 2u);
  ASSERT_EQ(read.bodies.size(), 2u);
  EXPECT_EQ(read.cloths[0].name, "sheet");
  EXPECT_EQ(read.cloths[0].triangles, written.cloths[0].triangles);
  ASSERT_EQ(read.cloths[0].frames.size(), 5u);
  EXPECT_EQ(read.cloths[0].frames[0], written.cloths[0].frames[0]);
  for (int k = 1; k < 5; ++k) {
    for (std::size_t i = 0; i < written.cloths[0].frames[k].size(); ++i) {
      // The difference from the first frame, below 1, is rounded to float, and so is the sum.
      EXPECT_NEAR(read.cloths[0].frames[k][i], written.cloths[0].frames[k][i], 1e-7);
    }
  }
  const AnimatedBody& ball = read.bodies[0];
  EXPECT_EQ(ball.name, "ball");
  EXPECT_EQ(ball.mesh.triangles, written.bodies[0].mesh.triangles);
  ASSERT_EQ(ball.poses.size(), 5u);
  EXPECT_LT((ball.poses[3].translation - written.bodies[0].poses[3].translation).norm(), 1e-7);
  EXPECT_LT(ball.poses[3].rotation.angularDistance(written.bodies[0].poses[3].rotation), 1e-6);
  EXPECT_FALSE(ball.shape.has_value());
  ASSERT_EQ(read.bodies[1].poses.size(), 1u);
  EXPECT_EQ(read.bodies[1].poses[0].translation, written.bodies[1].poses[0].translation)
      << "at rest: all its digits";
}

TEST(GlbReader, GivesBackTheNamesOfFabrics) {
  Animation written{.title = {}, .cloths = {make_cloth(2), make_cloth(2)}, .bodies = {}};
  written.cloths[0].fabric = "denim";
  const Animation read = write_and_read("fabrics", written);
  EXPECT_EQ(read.cloths[0].fabric, "denim");
  EXPECT_EQ(read.cloths[1].fabric, "");
}

TEST(GlbReader, GivesBackShapesInFullPrecision) {
  const Mat3 turned = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Sphere sphere{{1.0 / 3, 0, 2}, 0.1};
  const Plane plane{{0, 1e-17, 0}, Vec3(1, 2, 3).normalized()};
  const Capsule capsule{{0, 1, 2}, {1.0 / 7, 1, 2}, 1};
  const OrientedBox box{{1, 2, 3}, {0.1, 0.2, 0.3}, turned};
  const Animation read =
      write_and_read("shapes", {.title = "",
                                .cloths = {make_cloth(2)},
                                .bodies = {make_body("s", sphere), make_body("p", plane),
                                           make_body("c", capsule), make_body("b", box, 2)}});
  const auto& s = std::get<Sphere>(*read.bodies[0].shape);
  EXPECT_EQ(s.center, sphere.center);
  EXPECT_EQ(s.radius, sphere.radius);
  const auto& p = std::get<Plane>(*read.bodies[1].shape);
  EXPECT_EQ(p.point, plane.point);
  EXPECT_EQ(p.normal, plane.normal);
  const auto& c = std::get<Capsule>(*read.bodies[2].shape);
  EXPECT_EQ(c.a, capsule.a);
  EXPECT_EQ(c.b, capsule.b);
  EXPECT_EQ(c.radius, capsule.radius);
  const auto& b = std::get<OrientedBox>(*read.bodies[3].shape);
  EXPECT_EQ(b.center, box.center);
  EXPECT_EQ(b.half_size, box.half_size);
  EXPECT_EQ(b.rotation, box.rotation);
}

TEST(GlbReader, ReadsAStill) {
  const Animation read =
      write_and_read("still_again", {.title = "", .cloths = {make_cloth(1)}, .bodies = {}});
  ASSERT_EQ(read.cloths.size(), 1u);
  EXPECT_EQ(read.cloths[0].frames.size(), 1u);
}

TEST(GlbReader, ReadsAFrameWhenItIsAskedForIt) {
  const Animation written{.title = "", .cloths = {make_cloth(40)}, .bodies = {make_body("ball", {}, 40)}};
  const std::string file = (make_own_folder() / "lazy.glb").string();
  write_glb(file, written);
  const Animation all = read_glb(file);
  GlbFrames frames(file);
  ASSERT_EQ(frames.num_frames(), 40);
  EXPECT_TRUE(frames.meshes().cloths[0].frames.empty());
  for (const int k : {39, 0, 17}) {
    const AnimationFrame frame = frames.read(k);
    EXPECT_EQ(frame.cloths[0], all.cloths[0].frames[k]);
    EXPECT_EQ(frame.poses[0], all.bodies[0].poses[k]);
  }
  // The end of the file is the end of its buffer, with frames. They are damaged only for those who read them.
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  EXPECT_EQ(frames.read(1).cloths[0], all.cloths[0].frames[1]);
  try {
    frames.read(39);
    FAIL() << "read a frame that is not there";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), file + ": cannot be read");
  }
}

TEST(GlbReader, ReadsTheParticlesOfShownVertices) {
  AnimatedCloth cloth = make_cloth(3);
  const int num_particles = 4 * 5;
  ShownVertices shown{.particles = {-1}, .triangles = {}, .rest = {7, 8, 9}, .texture = {0, 1}};
  for (int v = 0; v < 2 * num_particles; ++v) {  // every particle twice, in reverse order
    shown.particles.push_back(num_particles - 1 - v % num_particles);
    shown.rest.insert(shown.rest.end(), 3, 0.0f);
    shown.texture.insert(shown.texture.end(), {0.1f, 0.2f});
  }
  for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
    Triangle& triangle = shown.triangles.emplace_back(cloth.triangles[t]);
    for (int& corner : triangle) corner = 1 + num_particles - 1 - corner + (t % 2 == 0 ? num_particles : 0);
  }
  cloth.fabric_coordinates.resize(2 * num_particles);
  std::iota(cloth.fabric_coordinates.begin(), cloth.fabric_coordinates.end(), 0.0f);
  Animation written{.title = "", .cloths = {cloth}, .bodies = {}};
  write_glb(output_file("particles"), written);
  written.cloths[0].shown = shown;
  write_glb(output_file("shown"), written);
  const Animation as_particles = read_glb(output_file("particles")), read = read_glb(output_file("shown"));
  EXPECT_EQ(read.cloths[0].triangles, cloth.triangles);
  EXPECT_EQ(read.cloths[0].fabric_coordinates, cloth.fabric_coordinates);
  EXPECT_EQ(read.cloths[0].frames, as_particles.cloths[0].frames);

  written.cloths[0].shown->particles[3] = num_particles;
  EXPECT_THROW(write_glb(output_file("shown"), written), InputError);
  written.cloths[0].shown = shown;
  written.cloths[0].shown->texture.pop_back();
  EXPECT_THROW(write_glb(output_file("shown"), written), InputError);
}

TEST(GlbReader, NamesTheFileAndWhatIsWrong) {
  EXPECT_THROW(read_glb("no/such/file.glb"), InputError);
  EXPECT_THROW(read_glb(testing::TempDir()), InputError);
  EXPECT_NE(complaint("").find("broken.glb: "), std::string::npos);
  EXPECT_NE(complaint("solid ball").find("expected one that weft run wrote"), std::string::npos);

  write_glb(output_file("to_break"),
            {.title = "", .cloths = {make_cloth(3)}, .bodies = {make_body("s", Sphere{})}});
  const std::string whole = read_bytes(output_file("to_break"));
  ASSERT_EQ(complaint(whole), "");
  for (const double part : {0.001, 0.1, 0.5, 0.9}) {
    const auto size = static_cast<std::size_t>(part * static_cast<double>(whole.size()));
    EXPECT_NE(complaint(whole.substr(0, size)).find("not a complete .glb"), std::string::npos) << part;
  }

  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string bytes = whole;
    EXPECT_EQ(from.size(), to.size());
    for (auto place = bytes.find(from); place != std::string::npos; place = bytes.find(from, place)) {
      bytes.replace(place, from.size(), to);
    }
    return complaint(bytes);
  };
  EXPECT_NE(changed("\"weft\"", "\"west\"").find("no node has Weft's mark"), std::string::npos);
  EXPECT_NE(changed("\"sphere\"", "\"spheer\"").find("expected sphere, plane, capsule, box or mesh"),
            std::string::npos);
  EXPECT_NE(changed("\"radius\":1.0", "\"radius\":-10").find("must be positive"), std::string::npos);
  EXPECT_NE(changed("\"center\"", "\"centre\"").find("must be 3 numbers"), std::string::npos);
  EXPECT_NE(changed("\"POSITION\"", "\"POTITION\"").find("no positions"), std::string::npos);
}

/// The error message of parse_glb for a file with this text, followed by these numbers.
std::string complaint_of_parts(std::string text, std::string numbers) {
  const auto word = [](std::size_t value) {
    std::string bytes;
    for (int k = 0; k < 4; ++k) bytes += static_cast<char>(value >> (8 * k) & 0xff);
    return bytes;
  };
  text.resize((text.size() + 3) / 4 * 4, ' ');
  numbers.resize((numbers.size() + 3) / 4 * 4, '\0');
  const std::string chunks =
      word(text.size()) + "JSON" + text + word(numbers.size()) + std::string("BIN\0", 4) + numbers;
  const std::string bytes = "glTF" + word(2) + word(12 + chunks.size()) + chunks;
  try {
    parse_glb({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, "made.glb");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(GlbReader, NamesWhatIsWrongWithFilesThatNobodyWouldWrite) {
  const std::string head = R"({"asset":{"version":"2.0"},)";
  EXPECT_NE(complaint_of_parts(head + R"("buffers":[]})", "1234").find("made.glb: has no cloth"),
            std::string::npos);
  // tinygltf throws for an empty buffer, recurses for each bracket, and reads every file that the text names.
  const std::string outside = (make_own_folder() / "outside.bin").string();
  std::ofstream(outside) << "1234";
  const std::string broken[] = {
      R"("buffers":[{"byteLength":0}]})",
      R"("extras":)" + std::string(1'000'000, '[') + std::string(1'000'000, ']') + "}",
      R"("buffers":[{"byteLength":4,"uri":")" + outside + R"("}]})"};
  for (const std::string& tail : broken) {
    EXPECT_NE(complaint_of_parts(head + tail, "1234").find("made.glb: is not a complete .glb file"),
              std::string::npos)
        << tail.substr(0, 100);
  }
}

}  // namespace
}  // namespace weft::engine
