/// `weft check` tests sizes and the initial state, not only keys.

#include <array>

#include "tests/app/program.h"

namespace weft::engine {
namespace {

/// A closed box with a corner at `low`, as an OBJ file.
void write_box(const std::string& file, const std::array<double, 3>& low, const std::array<double, 3>& size) {
  std::ofstream out(file);
  for (int corner = 0; corner < 8; ++corner) {
    out << 'v';
    for (int axis = 0; axis < 3; ++axis) out << ' ' << low[axis] + (corner >> axis & 1) * size[axis];
    out << '\n';
  }
  out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

/// A shirt and a body next to it.
void write_dressed_scene() {
  write_box("shirt.obj", {1, 1, 0}, {0.6, 0.7, 0.25});
  write_box("lying.obj", {1, 0, 1}, {0.6, 0.25, 0.7});
  write_box("body.obj", {0, 0, 0}, {0.5, 1.8, 0.3});
  std::ofstream("scene.toml") << "[scene]\nformat = 1\n[[cloth]]\nname = \"shirt\"\nmesh = \"shirt.obj\"\n"
                                 "fabric = \"cotton_shirting\"\n"
                                 "[[collider]]\nname = \"body\"\nshape = \"mesh\"\nfile = \"body.obj\"\n";
}

TEST_F(App, CheckTellsSizes) {
  write_dressed_scene();
  const Finished done = shell("weft check scene.toml");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(contains(done.out, "cloth \"shirt\": 0.6 m wide, 0.7 m high, 0.25 m deep, 12 triangles"))
      << done.out;
  EXPECT_TRUE(contains(done.out, "collider \"body\": 0.5 m wide, 1.8 m high, 0.3 m deep")) << done.out;
}

TEST_F(App, CheckAsksForTheUnitOfWhatIsHuge) {
  write_dressed_scene();
  const std::string huge = "weft check scene.toml --set 'collider[0].scale=100'";
  const Finished done = shell(huge);
  EXPECT_TRUE(
      contains(done.out, "collider \"body\" is 180 m large; is its file in centimetres? scale = 1\n"));
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_EQ(shell(huge + " --strict").exit_code, 1);
  EXPECT_TRUE(contains(shell("weft check scene.toml --set 'cloth[0].scale=1000'").out,
                       "cloth \"shirt\" is 700 m large; is its file in millimetres? scale = 1\n"));
  const Finished small = shell("weft check scene.toml --set 'cloth[0].scale=0.01'");
  EXPECT_TRUE(contains(small.out, "is cloth \"shirt\" too small? scale = 1\n")) << small.out;
  const Finished large = shell("weft check scene.toml --set 'cloth[0].scale=9'");
  EXPECT_TRUE(contains(large.out, "is the file of cloth \"shirt\" in feet? scale = 2.7432")) << large.out;
}

TEST_F(App, CheckAsksWhetherZPointsUp) {
  write_dressed_scene();
  EXPECT_FALSE(contains(shell("weft check scene.toml").out, "up ="));
  const std::string lying = "weft check scene.toml --set 'cloth[0].mesh=lying.obj'";
  EXPECT_TRUE(contains(shell(lying).out, "lies on its back beside collider \"body\"")) << shell(lying).out;
  EXPECT_FALSE(contains(shell(lying + " --set 'cloth[0].up=z'").out, "lies on its back"));
  write_box("z_up.obj", {0.9, -0.15, 0}, {0.8, 0.3, 1.8});
  const std::string body = "weft check scene.toml --set 'collider[0].file=z_up.obj'";
  EXPECT_TRUE(contains(shell(body).out, "collider \"body\" lies on its back beside cloth \"shirt\""))
      << shell(body).out;
  EXPECT_FALSE(contains(shell(body + " --set 'collider[0].up=z'").out, "lies on its back"));
}

TEST_F(App, CheckSeesACrossedStart) {
  write_dressed_scene();
  const std::string crossed =
      "weft check scene.toml --set 'cloth[0].position=[-0.8,0,0]' --set solver.untangle=false";
  const Finished done = shell(crossed);
  EXPECT_EQ(done.exit_code, 2) << "as of a run";
  EXPECT_TRUE(contains(done.err, "at the start cloth \"shirt\" triangle")) << done.err;
  EXPECT_TRUE(contains(done.err, "solver.untangle = false does not repair")) << done.err;
  EXPECT_FALSE(contains(done.out, ": OK")) << done.out;
  const std::string allowed = crossed + " --set solver.crossed_start=allow";
  EXPECT_EQ(shell(allowed).exit_code, 0);
  EXPECT_TRUE(contains(shell(allowed).out, "at the start cloth \"shirt\" triangle"));
  EXPECT_EQ(shell(allowed + " --strict").exit_code, 1);
}

TEST_F(App, CheckFindsAMovingBodyBesideASceneNamedWithoutAFolder) {
  write_dressed_scene();
  for (const char* frame : {"walk_0.obj", "walk_1.obj"}) write_box(frame, {0, 0, 0}, {0.5, 1.8, 0.3});
  const Finished done =
      shell("sed -i 's/file = .*/frames = \"walk_*.obj\"/' scene.toml && weft check scene.toml");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(contains(done.out, "collider \"body\": 0.5 m wide")) << done.out << done.err;
}

TEST_F(App, CheckTellsOfOpenSeamsAndRunOfThoseThatItSewed) {
  std::ofstream("strip.obj") << "v 0 0 0\nv 0.1 0 0\nv 0 0 0.1\nv 0.1 0 0.1\n"
                                "v 0.101 0 0\nv 0.2 0 0\nv 0.101 0 0.1\nv 0.2 0 0.1\n"
                                "f 1 3 4 2\nf 5 7 8 6\n";
  std::ofstream("strip.toml") << "[scene]\nformat = 1\n[[cloth]]\nmesh = \"strip.obj\"\n";
  const Finished open = shell("weft check strip.toml");
  EXPECT_TRUE(contains(open.out, "2 borders are 1.0 mm apart: sew = 0.00")) << open.out << open.err;
  const Finished sewn = shell("weft run strip.toml --frames 1 --set cloth[0].sew=0.002");
  EXPECT_EQ(sewn.exit_code, 0) << sewn.err;
  EXPECT_TRUE(contains(sewn.out, "note: cloth \"cloth\" (strip.obj): sewed 1 seam")) << sewn.out;
}

TEST_F(App, CheckIsStrictlyContentWithShippedGarments) {
  for (const char* scene :
       {"garment", "garment_hung", "contact/garment_body", "contact/self_crossing_body"}) {
    const Finished done = shell(std::string("weft check --strict ") + scene);
    EXPECT_EQ(done.exit_code, 0) << done.out << done.err;
    EXPECT_TRUE(contains(done.out, ": OK")) << done.out;
  }
}

TEST_F(App, AFabricNeedsNoTextureCoordinates) {
  const Finished done = shell("weft run garment --set 'cloth[0].fabric=denim' --frames 1");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(contains(done.out, "it is set upwards, warp = [0, 1, 0]")) << done.out;
}

}  // namespace
}  // namespace weft::engine
