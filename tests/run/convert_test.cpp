/// Converted files hold what the input held, and notes say what they cannot hold.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/own_folder.h"
#include "tests/read_text.h"
#include "weft/error.h"
#include "weft/io.h"

namespace weft {
namespace {

namespace fs = std::filesystem;

class Convert : public testing::Test {
 protected:
  void SetUp() override {
    PointCacheWriter writer(path("in.pc2"), 1, {0, 0, 0});
    for (const float x : {1.0f, 2.0f, 3.0f}) writer.add_frame(std::vector<float>{x, 10 * x, -x});
    writer.finish();
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }

  const fs::path folder_ = engine::make_own_folder();
};

/// Polygons, a seam in the texture, groups, an object.
const std::string kShirt =
    "v 0 0 0\nv 1 0 0\nv 1 1 0.1\nv 0 1 0\nv 2 0 0\nvt 0 0\nvt 0.5 0\nvt 0.5 1\nvt 0.1 0.3333333333333333\n"
    "o shirt\ng front\nf 1/1 2/2 3/3 4/4\ng back hem\nf 2/1 5/2 3/3\n";

TEST_F(Convert, ObjToPlyAndBackKeepsFacesAndTextureCoordinates) {
  const std::string in = write("shirt.obj", kShirt);
  const Converted there = convert(in, path("shirt.ply"));
  EXPECT_EQ(there.notes,
            std::vector<std::string>{in + " has 4 groups, which are lost: only .obj holds them"});
  EXPECT_TRUE(convert(path("shirt.ply"), path("again.obj")).notes.empty());
  const MeshFromFile shirt = read_mesh(in);
  EXPECT_EQ(shirt.faces.sizes, (std::vector<int>{4, 3}));
  ASSERT_EQ(shirt.faces.groups.size(), 4u);
  EXPECT_EQ(shirt.faces.groups[3], (MeshGroup{.name = "hem", .faces = {1}}));
  for (const char* name : {"shirt.ply", "again.obj"}) {
    const MeshFromFile read = read_mesh(path(name));
    EXPECT_EQ(read.mesh.positions, shirt.mesh.positions);
    EXPECT_EQ(read.faces.sizes, shirt.faces.sizes);
    EXPECT_EQ(read.faces.corners, shirt.faces.corners);
    EXPECT_EQ(read.faces.uv, shirt.faces.uv);
  }
}

TEST_F(Convert, ObjToObjKeepsEveryLine) {
  convert(write("shirt.obj", kShirt), path("same.obj"));
  EXPECT_EQ(engine::read_text(path("same.obj")), kShirt);
}

TEST_F(Convert, FramesUnitAndAxisOfAPointCache) {
  const Converted done =
      convert(path("in.pc2"), path("new/out.mdd"),
              {.fps = 8, .up_is_z = true, .scale = 0.5, .first_frame = 1, .last_frame = 2});
  EXPECT_EQ(done.files, std::vector<std::string>{path("new/out.mdd")});
  const PointCacheFile file(path("new/out.mdd"));
  EXPECT_EQ(file.times(), (std::vector<float>{0.125f, 0.25f}));
  ASSERT_EQ(file.num_frames(), 2);
  EXPECT_EQ(file.frame(0), (std::vector<float>{1, -1, -10}));  // (x, z, -y) / 2
}

TEST_F(Convert, NotesWhatAFormatDoesNotSay) {
  const Converted caches = convert(path("in.pc2"), path("out.mdd"));
  ASSERT_EQ(caches.notes.size(), 2u);
  EXPECT_EQ(caches.notes[0], path("in.pc2") + " does not say its frames per second: 60 (--fps)");
  EXPECT_EQ(caches.notes[1],
            path("in.pc2") + " is 0 m large; --scale gives the length of its unit in metres");
  EXPECT_EQ(convert(path("in.pc2"), path("out.pc2")).notes.size(), 1u) << "a PC2 needs no times";
}

TEST_F(Convert, MistakesAreNamed) {
  const auto message_of = [&](const std::string& in, const std::string& out, const ConvertOptions& options) {
    try {
      convert(path(in), path(out), options);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  EXPECT_EQ(message_of("in.pc2", "o.mdd", {.fps = 0}),
            "ConvertOptions::fps: expected a number above 0, found 0.0");
  EXPECT_EQ(message_of("in.pc2", "o.mdd", {.scale = -1}),
            "ConvertOptions::scale: expected a number above 0, found -1.0");
  EXPECT_EQ(message_of("in.pc2", "o.mdd", {.first_frame = 3}),
            path("in.pc2") + " has the frames 0 to 2; it has not 3 to 2");
  EXPECT_EQ(message_of("in.pc2", "o.txt", {}), path("o.txt") + ": a point cache is written as .pc2 or .mdd");
  EXPECT_EQ(message_of("in.pc2", "o.USDA", {}),
            path("o.USDA") + ": USD files are converted by `python -m weft convert`");
  EXPECT_FALSE(fs::exists(path("o.mdd")));
}

}  // namespace
}  // namespace weft
