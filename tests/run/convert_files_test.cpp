/// Converted files hold what the input held, and notes say what they cannot hold.

#include "weft/run/convert_files.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/read_text.h"
#include "weft/error.h"
#include "weft/io/mesh_files.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

class ConvertFiles : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  Converted convert(const fs::path& in, const std::string& out, const ConvertOptions& options = {}) const {
    return convert_files(in, folder_ / out, options);
  }

  const fs::path folder_ =
      fs::path(WEFT_OUTPUT_DIR) / testing::UnitTest::GetInstance()->current_test_info()->name();
};

/// Polygons, a seam in the texture, groups, an object.
const std::string kShirt =
    "v 0 0 0\nv 1 0 0\nv 1 1 0.1\nv 0 1 0\nv 2 0 0\nvt 0 0\nvt 0.5 0\nvt 0.5 1\nvt 0.1 0.3333333333333333\n"
    "o shirt\ng front\nf 1/1 2/2 3/3 4/4\ng back hem\nf 2/1 5/2 3/3\n";

TEST_F(ConvertFiles, ObjToPlyAndBackKeepsFacesAndTextureCoordinates) {
  const fs::path in = write("shirt.obj", kShirt);
  const Converted there = convert(in, "shirt.ply");
  EXPECT_EQ(there.notes,
            std::vector<std::string>{in.string() + " has 4 groups, which are lost: only .obj holds them"});
  EXPECT_TRUE(convert(folder_ / "shirt.ply", "again.obj").notes.empty());
  const MeshFromFile shirt = read_mesh(in);
  for (const char* name : {"shirt.ply", "again.obj"}) {
    const MeshFromFile read = read_mesh(folder_ / name);
    EXPECT_EQ(read.mesh.positions, shirt.mesh.positions);
    EXPECT_EQ(read.faces.corners, shirt.faces.corners);
    EXPECT_EQ(read.faces.ends, shirt.faces.ends);
    EXPECT_EQ(read.faces.uv, shirt.faces.uv);
  }
}

TEST_F(ConvertFiles, ObjToObjKeepsEveryLine) {
  convert(write("shirt.obj", kShirt), "same.obj");
  EXPECT_EQ(read_text(folder_ / "same.obj"), kShirt);
}

}  // namespace
}  // namespace weft::engine
