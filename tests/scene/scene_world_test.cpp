#include "weft/scene/scene_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include "tests/message_of.h"
#include "tests/own_folder.h"
#include "weft/core/angle.h"
#include "weft/error.h"
#include "weft/face/world_impl.h"
#include "weft/io/mesh_files.h"
#include "weft/io/obj_reader.h"
#include "weft/mesh/clean.h"
#include "weft/mesh/sample_meshes.h"
#include "weft/mesh/solid.h"
#include "weft/scene/cloth_faces.h"
#include "weft/scene/scene_reader.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

TEST(SceneWorld, StiffensTheSpringsOfARegion) {
  const std::string text = R"([scene]
format = 1
[[cloth]]
grid = { size = [1, 1], cells = [4, 4] }
[cloth.fabric]
spring_structural = 100
[[cloth.stiffen]]
select = { box = { min = [-1, -1, -1], max = [0.3, 1, 2] } }
factor = 5
[[cloth.stiffen]]
select = { index = [0, 1] }
factor = 2
)";
  const SceneWorld scene = build_world(parse_scene(text, "scene.toml"), make_serial_jobs());
  const ClothModel& model = scene.world.model(scene.world.cloth(0));
  const auto column = [](int particle) { return particle % 5; };
  for (int s = 0; s < static_cast<int>(model.topology->springs.size()); ++s) {
    const Spring& spring = model.topology->springs[s];
    const bool is_in_box = column(spring.i) <= 1 && column(spring.j) <= 1;
    const bool is_first = spring.i == 0 && spring.j == 1;
    EXPECT_EQ(model.stiffness(s), model.stiffness(spring.kind) * (is_in_box ? 5 : 1) * (is_first ? 2 : 1));
  }
  EXPECT_THROW(build_world(parse_scene(text + R"([[cloth.stiffen]]
select = { sphere = { center = [9, 9, 9], radius = 1 } }
factor = 2
)",
                                       "scene.toml"),
                           make_serial_jobs()),
               InputError);
}

/// A tube of cells of about 1 cm, 10 cm wide and 12 cm high, with a hem of height `hem` below; 0: none [m].
TriangleMesh make_tube(double hem) {
  constexpr int kAround = 30, kRows = 12;
  std::vector<double> heights;
  if (hem > 0) heights.push_back(-hem);
  for (int row = 0; row <= kRows; ++row) heights.push_back(0.01 * row);
  TriangleMesh mesh;
  for (const double y : heights) {
    for (int i = 0; i < kAround; ++i) {
      const auto [sin, cos] = sin_cos_deg(360.0 * i / kAround);
      mesh.positions.emplace_back(0.05 * cos, y, 0.05 * sin);
    }
  }
  for (int row = 0; row + 1 < static_cast<int>(heights.size()); ++row) {
    for (int i = 0; i < kAround; ++i) {
      const int a = row * kAround + i, b = row * kAround + (i + 1) % kAround, c = a + kAround,
                d = b + kAround;
      if ((row + i) % 2 == 0) {
        mesh.triangles.insert(mesh.triangles.end(), {{a, d, b}, {a, c, d}});
      } else {
        mesh.triangles.insert(mesh.triangles.end(), {{a, c, b}, {b, c, d}});
      }
    }
  }
  return mesh;
}

/// Results of half a second of a tube that falls on a ball, which stops its hem.
struct Fall {
  int parts = 0;       // that steps were divided into
  double stretch = 0;  // maximum
  std::vector<std::string> warnings;
};

Fall drop(const TriangleMesh& tube) {
  const std::filesystem::path folder = make_own_folder();
  write_obj(folder / "tube.obj", tube);
  write_obj(folder / "ball.obj", make_sphere_mesh(Vec3::Zero(), 0.055, 14));
  const std::string text =
      "[scene]\nformat = 1\n[[cloth]]\nmesh = \"tube.obj\"\nfabric = \"denim\"\n"
      "position = [0.004, 0.045, 0.003]\n[[collider]]\nshape = \"mesh\"\nfile = \"ball.obj\"\n";
  SceneWorld scene = build_world(parse_scene(text, folder / "scene.toml"), make_serial_jobs());
  std::filesystem::remove_all(folder);
  Fall fall{.warnings = scene.warnings};
  for (int frame = 0; frame < 30; ++frame) {
    fall.parts += scene.world.step(1.0 / 60).divisions;
    const ClothId tube_id = scene.world.cloth(0);
    fall.stretch =
        std::max(fall.stretch,
                 compute_principal_stretches(scene.world.model(tube_id), scene.world.state(tube_id))->max);
  }
  return fall;
}

TEST(SceneWorld, DividesNoStepForShortEdgesAtAHem) {
  // Edges of 0.4 mm, half of denim's thickness. If they were kept, contact would stretch them by 25 % instead
  // of 2 %, and divide steps into 100 parts instead of 42. The triangles' pairs are others: 62 parts.
  const Fall expected = drop(make_tube(0)), fall = drop(make_tube(4e-4));
  EXPECT_LE(fall.parts, expected.parts + 30);
  EXPECT_LT(fall.stretch, expected.stretch + 0.01);
  EXPECT_TRUE(std::ranges::any_of(fall.warnings, [](const std::string& w) {
    return w.find("or with an edge below 15 % of the longest around and") != std::string::npos;
  }));
}

TEST(SceneWorld, SewsPiecesAndTellsSo) {
  const std::filesystem::path folder = make_own_folder();
  std::ofstream(folder / "pieces.obj") << "v 0 0 0\nv 0.1 0 0\nv 0 0 0.1\nv 0.1 0 0.1\n"
                                          "v 0.101 0 0\nv 0.101 0 0.1\nv 0.2 0 0.05\nv 0.101 0 0.06\n"
                                          "vt 0 0\nvt 0.1 0\nvt 0 0.1\nvt 0.1 0.1\n"
                                          "f 1/1 3/3 2/2\nf 2/2 3/3 4/4\nf 5/1 8/2 7/4\nf 8/2 6/3 7/4\n";
  const std::string text =
      "[scene]\nformat = 1\n[[cloth]]\nmesh = \"pieces.obj\"\nfabric = \"denim\"\nsew = 0.002\n"
      "pins = [\"index:4\", \"index:7\"]\n";
  const SceneWorld scene = build_world(parse_scene(text, folder / "scene.toml"), make_serial_jobs());
  std::filesystem::remove_all(folder);
  EXPECT_EQ(scene.notes, std::vector<std::string>{
                             "cloth \"cloth\" (pieces.obj): sewed 1 seam: 5 vertices, 1 edge divided"});
  EXPECT_EQ(scene.world.model(scene.world.cloth(0)).num_particles(), 6);
  EXPECT_EQ(scene.world.model(scene.world.cloth(0)).topology->mesh.num_triangles(), 5);
}

TEST(SceneWorld, StitchesTheLinesOfAFile) {
  const std::filesystem::path folder = make_own_folder();
  // Two squares with two lines between them, one of them twice; others trace an edge, or go to vertices without a face.
  const char* squares =
      "v 0 0 0\nv 0.1 0 0\nv 0 0 0.1\nv 0.1 0 0.1\nv 0.2 0 0\nv 0.3 0 0\nv 0.2 0 0.1\nv 0.3 0 0.1\n"
      "v 9 9 9\nf 1 3 4 2\nf 5 7 8 6\n";
  std::ofstream(folder / "panels.obj") << squares << "l 2 5\nl 4 -3\nl 1 2\nl 3 99\nl 3 9\nl 5 2\n";
  std::ofstream(folder / "plain.obj") << squares << "l 1 2\n";
  const auto build = [&](const std::string& keys) {
    const std::string text = "[scene]\nformat = 1\n[[cloth]]\nfabric = \"denim\"\nwarp = [1, 0, 0]\n" + keys;
    return build_world(parse_scene(text, folder / "scene.toml"), make_serial_jobs());
  };
  const SceneWorld sewn = build("mesh = \"panels.obj\"\nstitches = true\n");
  EXPECT_EQ(sewn.notes,
            std::vector<std::string>{
                "cloth \"cloth\" (panels.obj): 0 seams and 2 stitches draw together, from up to 0.1 m"});
  EXPECT_EQ(sewn.world.model(sewn.world.cloth(0)).topology->seams.springs.size(), 2u);
  const SceneWorld open = build("mesh = \"panels.obj\"\n");
  ASSERT_EQ(open.warnings.size(), 2u);
  EXPECT_EQ(
      open.warnings[0],
      "cloth \"cloth\": its file has 2 lines between vertices, as Blender's sewing; stitches = true draws "
      "them together");
  EXPECT_EQ(message_of([&] { build("mesh = \"plain.obj\"\nstitches = true\n"); }),
            "cloth \"cloth\": stitches are the lines of its file, l of an OBJ file, but it has none");
  EXPECT_NE(message_of([&] {
              build("mesh = \"panels.obj\"\nstitches = true\n[solver]\nintegrator = \"paper\"\n");
            }).find("does not support the seams"),
            std::string::npos);
  std::filesystem::remove_all(folder);
}

/// A square of 0.1 m, whose texture coordinates are 0.08 by 0.12; a second file of the same faces, 1 by 1.
class RestShapes : public ::testing::Test {
 protected:
  std::filesystem::path folder_ = make_own_folder();

  void SetUp() override {
    const char* faces = "f 1/1 3/3 4/4 2/2\n";
    std::ofstream(folder_ / "square.obj") << "v 0 0 0\nv 0.1 0 0\nv 0 0 0.1\nv 0.1 0 0.1\n"
                                             "vt 0 0\nvt 0.08 0\nvt 0 0.12\nvt 0.08 0.12\ng hem\n"
                                          << faces;
    std::ofstream(folder_ / "unit.obj")
        << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n"
        << faces;
    std::ofstream(folder_ / "other.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4 3\n";
  }
  SceneDesc read(const std::string& keys) const {
    return parse_scene("[scene]\nformat = 1\n[[cloth]]\nmesh = \"square.obj\"\nfabric = \"denim\"\n" + keys,
                       folder_ / "scene.toml");
  }

  /// Mass over density [m²].
  double area(const std::string& keys) const {
    const SceneWorld scene = build_world(read(keys), make_serial_jobs());
    const ClothModel& model = scene.world.model(scene.world.cloth(0));
    double mass = 0;
    for (const double m : model.mass) mass += m;
    return mass / model.material.density;
  }
};

TEST_F(RestShapes, AreReadInEveryForm) {
  EXPECT_NEAR(area(""), 0.01, 1e-15);
  EXPECT_NEAR(area("rest = \"uv\""), 0.01, 1e-15) << "of the area of the mesh";
  EXPECT_NEAR(area("rest = { uv_scale = 2 }"), 4 * 0.08 * 0.12, 1e-15);
  EXPECT_NEAR(area("rest = { mesh = \"unit.obj\" }"), 1, 1e-14);
  EXPECT_NEAR(area("rest = { mesh = \"unit.obj\", scale = 0.2, up = \"z\" }"), 0.04, 1e-15);
  EXPECT_NEAR(area("[[cloth.rest_scale]]\nselect = \"group:hem\"\nweft = 0.5\n"), 0.005, 1e-15);
  // Two of the three corners of each triangle lie in the sphere around a corner of the diagonal: factor 5/6 or 4/6.
  EXPECT_NEAR(area("position = [5, 0, 0]\n[[cloth.rest_scale]]\nwarp = 0.5\n"
                   "select = { box = { min = [4.99, -1, -1], max = [5.01, 1, 1] } }"),
              0.005 * (4.0 / 6 + 5.0 / 6), 1e-15);
}

TEST_F(RestShapes, AreSuggestedWhereTextureCoordinatesLookLikeAPattern) {
  const auto notes = [&](double u, double v) {
    std::ofstream(folder_ / "square.obj")
        << "v 0 0 0\nv 0.1 0 0\nv 0 0 0.1\nv 0.1 0 0.1\nvt 0 0\nvt " << u << " 0\nvt 0 " << v << "\nvt " << u
        << ' ' << v << "\nf 1/1 3/3 4/4 2/2\n";
    return build_world(read(""), make_serial_jobs()).notes;
  };
  EXPECT_EQ(
      notes(0.19, 0.21),
      std::vector<std::string>{
          "cloth \"cloth\" (square.obj): its texture coordinates look like its flat pattern, in units of "
          "0.4994 m: with rest = \"uv\" its edges would start at about 0.9536 to 1.054 times their lengths "
          "at rest"});
  EXPECT_TRUE(notes(0.2, 0.2).empty()) << "it would change nothing";
  EXPECT_TRUE(notes(0.1, 0.3).empty()) << "a picture's coordinates";
}

TEST_F(RestShapes, OfOtherFacesAreRefused) {
  const auto refusal = [&](const std::string& keys) {
    return message_of([&] { build_world(read(keys), make_serial_jobs()); });
  };
  EXPECT_NE(refusal("rest = { mesh = \"other.obj\" }").find("cloth \"cloth\": its rest shape: "),
            std::string::npos)
      << refusal("rest = { mesh = \"other.obj\" }");
  EXPECT_NE(refusal("rest = \"pattern\"").find("expected \"uv\", { uv_scale = 0.01 }"), std::string::npos);
  EXPECT_NE(refusal("rest = { scale = 2 }").find("requires \"mesh\"; texture coordinates have \"uv_scale\""),
            std::string::npos);
  EXPECT_NE(refusal("rest = { mesh = \"unit.obj\", uv_scale = 2 }").find("a mesh has \"scale\""),
            std::string::npos);
}

/// Two pieces with a seam between them, as groups; one vertex has a face without area only.
class GroupsOfAMesh : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_ / "pieces.obj")
        << "v 0 0 0\nv 0.1 0 0\nv 0 0 0.1\nv 0.1 0 0.1\nv 0.1 0 0\nv 0.1 0 0.1\nv 0.2 0 0.05\nv 0.3 0 0\n"
           "o shirt\ng left\nf 1 3 4 2\ng right cuff\nf 5 6 7\ng flat\nf 8 8 8\no hem\ng right\nf 5 6 7\n";
  }
  static std::string text(const std::string& keys) {
    return "[scene]\nformat = 1\n[[cloth]]\nname = \"top\"\nmesh = \"pieces.obj\"\nweld = true\n"
           "fabric = { spring_structural = 100 }\n" +
           keys;
  }
  PublicScene build(const std::string& keys) const {
    return build_scene(parse_scene(text(keys), folder_ / "scene.toml"), make_serial_jobs());
  }
  std::vector<int> pinned(const std::string& keys) const {
    const PublicScene scene = build(keys);
    return scene.world.pinned_particles(scene.world.cloth(0));
  }
  std::string failure(const std::string& keys) const {
    try {
      build(keys);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  // A folder of its own for each test: they may run at the same time.
  std::filesystem::path folder_ = make_own_folder();
};

TEST_F(GroupsOfAMesh, SelectTheParticlesOfTheirVertices) {
  const PublicScene scene = build("pins = [\"group:left\"]");
  const std::vector<int>& particles = scene.world.notes(scene.world.cloth(0)).particle_of_vertex;
  const auto particles_of = [&](std::vector<int> vertices) {
    std::set<int> result;
    for (const int v : vertices) result.insert(particles[v]);
    return std::vector<int>(result.begin(), result.end());
  };
  EXPECT_EQ(pinned("pins = [\"group:left\"]"), particles_of({0, 1, 2, 3}));
  EXPECT_EQ(pinned("pins = [\"group:right\"]"), particles_of({4, 5, 6}));
  EXPECT_EQ(pinned("pins = [\"group:cuff\"]"), particles_of({4, 5, 6}));
  EXPECT_EQ(pinned("[[cloth.pin]]\nselect = { group = \"hem\" }"), particles_of({4, 5, 6}));
  EXPECT_EQ(pinned("pins = [\"group:shirt\"]"), particles_of({0, 1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(particles_of({1}), particles_of({4}));  // the seam belongs to both
}

TEST_F(GroupsOfAMesh, StiffenSprings) {
  const PublicScene scene = build("[[cloth.stiffen]]\nselect = \"group:left\"\nfactor = 3\n");
  const ClothId cloth = scene.world.cloth(0);
  const std::vector<int>& particles = scene.world.notes(cloth).particle_of_vertex;
  const ClothModel& model = WorldAccess::engine(scene.world).model(cloth);
  for (std::size_t s = 0; s < model.topology->springs.size(); ++s) {
    const Spring& spring = model.topology->springs[s];
    const bool is_left = spring.i != particles[6] && spring.j != particles[6];
    EXPECT_EQ(model.material.spring_factors[s], is_left ? 3 : 1);
  }
}

TEST_F(GroupsOfAMesh, AreListedWhereANameIsUnknown) {
  EXPECT_EQ(failure("pins = [\"group:lefd\"]"),
            "cloth \"top\" (pieces.obj): there is no group \"lefd\"; did you mean \"left\"? "
            "There are \"shirt\", \"left\", \"right\", \"cuff\", \"flat\", \"hem\"");
  EXPECT_EQ(failure("pins = [\"group:pocket\"]"),
            "cloth \"top\" (pieces.obj): there is no group \"pocket\"; "
            "there are \"shirt\", \"left\", \"right\", \"cuff\", \"flat\", \"hem\"");
  EXPECT_EQ(failure("pins = [\"group:flat\"]"),
            "cloth \"top\": group \"flat\" cannot be selected: its faces have no area");
  std::ofstream(folder_ / "pieces.obj") << "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n";
  EXPECT_EQ(failure("pins = [\"group:left\"]"),
            "cloth \"top\" (pieces.obj): there is no group \"left\"; the file names no groups (lines g or o "
            "of an OBJ "
            "file)");
}

TEST_F(GroupsOfAMesh, AreNotOfMeshesInMemory) {
  SceneDesc scene = parse_scene(text("pins = [\"group:left\"]"), folder_ / "scene.toml");
  MeshSource& source = std::get<MeshSource>(scene.cloths[0].shape);
  source.mesh = std::make_shared<weft::TriangleMesh>(
      weft::TriangleMesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, .triangles = {{0, 1, 2}}});
  try {
    build_scene(scene, make_serial_jobs());
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "cloth \"top\": there is no group \"left\"; only meshes in files have groups, select an index, a box "
        "or a sphere");
  }
}

TEST(ClothFaces, FacesOfAGridAreItsCells) {
  ClothSceneDesc cloth{.shape = Grid{.size_x = 1, .size_z = 1, .cells_x = 2, .cells_z = 1}};
  const MeshFaces faces = read_faces(cloth);
  EXPECT_EQ(faces.corners, (std::vector<int>{0, 3, 4, 1, 1, 4, 5, 2}));
  EXPECT_EQ(faces.ends, (std::vector<std::size_t>{4, 8}));
}

/// A scene with a sheet at height 1 and a box of side 1 as a mesh below it, in a temporary folder.
class MeshCollider : public testing::Test {
 protected:
  static TriangleMesh box() { return make_box_mesh(Vec3::Zero(), Vec3::Constant(0.5), Mat3::Identity()); }

  SceneWorld build(const TriangleMesh& mesh, const std::string& keys = "") {
    write_obj(folder_ / "body.obj", mesh);
    return build(keys);
  }

  SceneWorld build(const std::string& keys = "") {
    const std::string text = R"([scene]
format = 1
[[cloth]]
grid = { size = [1, 1], cells = [8, 8] }
position = [-0.5, 1, -0.5]
[[collider]]
name = "body"
shape = "mesh"
file = "body.obj"
)";
    return build_world(parse_scene(text + keys, folder_ / "scene.toml"), make_serial_jobs());
  }

  static const MeshShape& shape(const SceneWorld& built) {
    return std::get<MeshShape>(built.world.colliders().at(0).shape);
  }

  std::string failure(const std::string& obj) {
    std::ofstream(folder_ / "body.obj") << obj;
    try {
      build();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  const std::filesystem::path folder_ = make_own_folder();
};

TEST_F(MeshCollider, AndClothAreReadFromPlyAndStlToo) {
  const TriangleMesh cloth = build_grid_mesh({.cells_x = 2, .cells_z = 2}, GridDiagonals::alternating);
  write_mesh(folder_ / "cloth.obj", cloth.positions, make_faces(cloth.triangles));
  write_mesh(folder_ / "cloth.PLY", cloth.positions, make_faces(cloth.triangles));
  write_obj(folder_ / "body.obj", box());
  std::ofstream stl(folder_ / "body.stl");
  stl << "solid box\n";
  for (const Triangle& t : box().triangles) {
    stl << "facet normal 0 0 0\nouter loop\n";
    for (const int v : t) stl << "vertex " << box().positions[v].transpose() << '\n';
    stl << "endloop\nendfacet\n";
  }
  stl << "endsolid box\n";
  stl.close();
  const auto build_from = [&](const std::string& cloth_file, const std::string& body_file) {
    return build_world(parse_scene("[scene]\nformat = 1\n[[cloth]]\nmesh = \"" + cloth_file +
                                       "\"\nposition = [0, 5, 0]\n[[collider]]\nshape = \"mesh\"\nfile = \"" +
                                       body_file + "\"\n",
                                   folder_ / "scene.toml"),
                       make_serial_jobs());
  };
  const SceneWorld obj = build_from("cloth.obj", "body.obj"), others = build_from("cloth.PLY", "body.stl");
  EXPECT_EQ(positions_of(others.world.state(others.world.cloth(0))),
            positions_of(obj.world.state(obj.world.cloth(0))));
  EXPECT_EQ(shape(others).mesh->num_vertices(), 8);
  EXPECT_NEAR(compute_signed_volume(*shape(others).mesh), compute_signed_volume(*shape(obj).mesh), 1e-15);
}

bool warns(const SceneWorld& built, const std::string& words) {
  return std::any_of(built.warnings.begin(), built.warnings.end(),
                     [&](const std::string& w) { return w.find(words) != std::string::npos; });
}

TEST_F(MeshCollider, IsSewnAndPlaced) {
  const SceneWorld built =
      build(box(), "up = \"z\"\nscale = 0.5\nposition = [0, 0.5, 0]\nrotation = [0, 45, 0]\n");
  EXPECT_TRUE(built.warnings.empty()) << testing::PrintToString(built.warnings);
  EXPECT_EQ(shape(built).mesh->num_vertices(), 8) << "three corners of faces in each";
  EXPECT_NEAR(compute_signed_volume(*shape(built).mesh), 0.125, 1e-15);
  EXPECT_EQ(shape(built).translation, Vec3(0, 0.5, 0));
  EXPECT_EQ(shape(built).rotation, rotation_from_angles_deg({0, 45, 0}));
}

TEST_F(MeshCollider, WithoutTrianglesIsNamed) {
  for (const char* obj : {"", "v 0 0 0\n", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"}) {
    EXPECT_NE(failure(obj).find("collider \"body\""), std::string::npos) << failure(obj);
    EXPECT_NE(failure(obj).find("body.obj"), std::string::npos) << failure(obj);
  }
}

TEST_F(MeshCollider, InsideOutIsTurnedAndNamed) {
  TriangleMesh mesh = box();
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  const SceneWorld built = build(mesh);
  EXPECT_TRUE(warns(built, "collider \"body\" (body.obj): is inside out"));
  EXPECT_TRUE(warns(built, "flipped"));
  EXPECT_NEAR(compute_signed_volume(*shape(built).mesh), 1, 1e-15);
}

TEST_F(MeshCollider, WithABorderIsNamed) {
  TriangleMesh mesh = box();
  mesh.triangles.resize(10);
  EXPECT_TRUE(warns(build(mesh), "collider \"body\" (body.obj): has a border of 4 edges"));
}

TEST_F(MeshCollider, WithSmallHolesIsFilledAndNamed) {
  const TriangleMesh whole = clean_mesh(make_sphere_mesh(Vec3::Zero(), 0.5, 20), {.weld_distance = 0}).mesh;
  TriangleMesh mesh = whole;
  std::erase_if(mesh.triangles, [](const Triangle& t) { return t[0] == 50 || t[1] == 50 || t[2] == 50; });
  const SceneWorld built = build(mesh);
  EXPECT_TRUE(warns(built, "has 1 hole, up to "));
  EXPECT_TRUE(warns(built, " wide; it was filled (solid = false leaves them open)"));
  EXPECT_NEAR(compute_signed_volume(*shape(built).mesh), compute_signed_volume(whole), 0.005);
  const SceneWorld open = build(mesh, "solid = false\n");
  EXPECT_TRUE(warns(open, "has a border of 6 edges: cloth collides with both sides there"));
  EXPECT_EQ(shape(open).mesh->num_triangles(), mesh.num_triangles());
}

TEST_F(MeshCollider, WithALargeHoleIsFilledOnDemand) {
  TriangleMesh mesh = box();
  mesh.triangles.resize(10);
  EXPECT_TRUE(warns(build(mesh), "; solid = true fills holes"));
  const SceneWorld built = build(mesh, "solid = true\n");
  EXPECT_TRUE(warns(built, "has 1 hole, up to 1.13e+03 mm wide; it was filled"));
  EXPECT_NEAR(compute_signed_volume(*shape(built).mesh), 1, 1e-15);
}

TEST_F(MeshCollider, WithAnOpenShellIsSolidElsewhere) {
  TriangleMesh mesh = box();
  const int first = mesh.num_vertices();
  for (const Vec3& p : {Vec3(0, 0.8, 0), Vec3(0.1, 0.8, 0), Vec3(0, 0.8, 0.1)}) mesh.positions.push_back(p);
  mesh.triangles.push_back({first, first + 1, first + 2});
  const SceneWorld built =
      build(mesh, "[solver]\ncontact = false\n[[cloth]]\ngrid = { size = [0.2, 0.2], cells = [2, 2] }\n");
  EXPECT_TRUE(warns(built, "9 particles inside collider \"body\""));
}

TEST_F(MeshCollider, ThatIsOpenAroundClothIsNamed) {
  TriangleMesh mesh = box();
  mesh.triangles.resize(10);
  for (Vec3& p : mesh.positions) p *= 4;
  EXPECT_TRUE(
      warns(build(mesh), "81 particles of cloth \"cloth\" start within collider \"body\", which is open"));
  EXPECT_FALSE(warns(build(mesh, "solid = false\n"), "which is open"));
  EXPECT_FALSE(warns(build(mesh, "[solver]\ncontact = false\n"), "which is open"));
}

TEST_F(MeshCollider, WithTwistedTrianglesOrFinsIsNamed) {
  TriangleMesh mesh = box();
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  const SceneWorld oriented = build(mesh);
  EXPECT_TRUE(warns(oriented, "1 triangle faced another way than most around; it was flipped"));
  EXPECT_NEAR(compute_signed_volume(*shape(oriented).mesh), 1, 1e-15);
  mesh = box();
  mesh.positions.emplace_back(0, 2, 0);
  mesh.triangles.push_back({0, 1, 24});
  EXPECT_TRUE(warns(build(mesh), "1 edge of more than two triangles"));
}

TEST_F(MeshCollider, OverTheClothIsNamed) {
  // The inner 5 × 5 of the sheet's particles are inside the box, those on its sides at ±0.5 are not.
  const SceneWorld built = build(box(), "scale = 0.6\nposition = [0, 0.9, 0]\n");
  EXPECT_TRUE(warns(built, "25 particles of cloth \"cloth\" are inside collider \"body\""))
      << testing::PrintToString(built.warnings);
  // With the motion's pose at the start.
  const SceneWorld away =
      build(box(), "scale = 0.6\nposition = [0, 0.9, 0]\nmotion = [{ time = 0, position = [0, -2, 0] }]\n");
  EXPECT_TRUE(away.warnings.empty()) << testing::PrintToString(away.warnings);
}

TEST_F(MeshCollider, WithABorderHasNoInside) {
  TriangleMesh mesh = box();
  mesh.triangles.resize(10);
  EXPECT_FALSE(warns(build(mesh, "position = [0, 0.9, 0]\n"), "starts with"));
}

TEST(SceneWorld, NamesAnalyticCollidersOverTheCloth) {
  const std::string text = R"([scene]
format = 1
[[cloth]]
name = "sheet"
grid = { size = [1, 1], cells = [8, 8] }
[[collider]]
name = "pole"
shape = "capsule"
a = [0.5, -1, 0.5]
b = [0.5, 1, 0.5]
radius = 0.1
[[collider]]
name = "crate"
shape = "box"
center = [0, 0, 0]
half_size = [0.2, 0.2, 0.2]
)";
  SceneDesc scene = parse_scene(text, "scene.toml");
  scene.untangle = false;
  const SceneWorld built = build_world(scene, make_serial_jobs());
  ASSERT_EQ(built.warnings.size(), 2u);
  EXPECT_TRUE(warns(built, "cloth \"sheet\" starts with 1 particle inside collider \"pole\""));
  EXPECT_TRUE(warns(built, "cloth \"sheet\" starts with 4 particles inside collider \"crate\""));
}

TEST(SceneWorld, OfShippedScenesHasNothingToWarnOf) {
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(std::filesystem::path(WEFT_SOURCE_DIR) / "scenes")) {
    if (entry.path().extension() != ".toml") continue;
    if (entry.path().filename() == "funnel.toml") continue;  // open on purpose, with a warning
    const SceneWorld built = build_world(read_scene(entry.path()), make_serial_jobs());
    EXPECT_TRUE(built.warnings.empty()) << entry.path() << testing::PrintToString(built.warnings);
  }
}

class Settle : public testing::Test {
 protected:
  SceneWorld build(const std::string& settle, const std::string& collider) const {
    return build_world(parse_scene("[scene]\nformat = 1\n" + settle + R"(
[[cloth]]
name = "sheet"
grid = { size = [1, 1], cells = [16, 16] }
fabric = "silk"
position = [-0.5, 0.25, -0.5]
)" + collider,
                                   folder_ / "scene.toml"),
                       make_serial_jobs());
  }

  /// Of the sheet's middle.
  static double height(const World& world) { return world.state(world.cloth(0)).position(8 * 17 + 8).y(); }

  const std::filesystem::path folder_ = make_own_folder();
};

TEST_F(Settle, LaysClothOnABodyThatStandsStillBeforeFrameZero) {
  const std::string ball = R"([[collider]]
name = "ball"
shape = "sphere"
center = [0, 0, 0]
radius = 0.2
motion = [{ time = 0 }, { time = 1, position = [5, 0, 0] }]
)";
  const SceneWorld before = build("", ball), after = build("settle = 1", ball);
  EXPECT_EQ(before.world.time(), 0);
  EXPECT_EQ(after.world.time(), 0);
  EXPECT_EQ(height(before.world), 0.25);
  // Edges are chords of the ball: particles stand above it by up to (0.0625 √2)²/(8 · 0.2) = 4.9 mm.
  EXPECT_NEAR(height(after.world), 0.2, 0.006) << "it lies on the ball";
  const ClothState& state = after.world.state(after.world.cloth(0));
  EXPECT_LT(state.position(0).y(), 0) << "its corners hang";
  for (std::size_t i = 0; i < state.v.size(); ++i) ASSERT_EQ(state.v.get(i), Vec3(Vec3::Zero()));
}

TEST_F(Settle, TakesABodyFromItsRestPoseToItsFirstPose) {
  // The body's first pose goes through the sheet; its rest pose lies below.
  write_obj(folder_ / "first.obj", make_sphere_mesh({0, 0, 0}, 0.3, 16));
  write_obj(folder_ / "rest.obj", make_sphere_mesh({0, 0, 0}, 0.2, 16));
  const std::string body = "[[collider]]\nname = \"body\"\nshape = \"mesh\"\nfile = \"first.obj\"\n";
  const SceneWorld built = build("settle = 0.5", body + "rest = \"rest.obj\"\n");
  EXPECT_TRUE(built.warnings.empty()) << testing::PrintToString(built.warnings);
  EXPECT_NEAR(height(built.world), 0.3, 0.004);
}

TEST_F(Settle, OfARestPoseNeedsItsTime) {
  write_obj(folder_ / "first.obj", make_sphere_mesh({0, 0, 0}, 0.2, 8));
  try {
    build("", "[[collider]]\nshape = \"mesh\"\nfile = \"first.obj\"\nrest = \"first.obj\"\n");
    FAIL() << "no mistake";
  } catch (const SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("rest: needs scene.settle"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace weft::engine
