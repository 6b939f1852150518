#include "weft/io/obj_reader.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <set>
#include <string>

#include "tests/own_folder.h"
#include "weft/core/angle.h"
#include "weft/error.h"

namespace weft::engine {
namespace {

const std::string kFourVertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TriangleMesh parse(const std::string& text) { return parse_obj(text, "x.obj").mesh; }

/// The error message for this text.
std::string failure(const std::string& text) {
  try {
    parse(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

double total_area(const TriangleMesh& mesh) {
  double area = 0;
  for (int t = 0; t < mesh.num_triangles(); ++t) area += triangle_area(mesh, t);
  return area;
}

std::string polygon_text(const std::vector<Vec3>& corners) {
  std::ostringstream text;
  text.precision(17);
  for (const Vec3& x : corners) text << "v " << x.transpose() << '\n';
  text << 'f';
  for (size_t k = 1; k <= corners.size(); ++k) text << ' ' << k;
  return text.str();
}

// ---- Valid files ----

TEST(ObjReader, KeepsTheFilesVertexOrder) {
  const TriangleMesh mesh = parse("v 9 9 9\nv 0 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 4 5 2\nv 7 7 7\n");
  ASSERT_EQ(mesh.num_vertices(), 6);  // unused and repeated ones too
  EXPECT_EQ(mesh.positions[0], Vec3(9, 9, 9));
  EXPECT_EQ(mesh.positions[5], Vec3(7, 7, 7));
  ASSERT_EQ(mesh.num_triangles(), 1);
  EXPECT_EQ(mesh.triangles[0], (Triangle{3, 4, 1}));
}

TEST(ObjReader, ReadsAllFormsOfFaceCorners) {
  for (const std::string face : {"f 1 2 3", "f 1/7 2/8 3/9", "f 1//7 2//8 3//9", "f 1/1/1 2/2/2 3/3/3"}) {
    EXPECT_EQ(parse(kFourVertices + face).triangles[0], (Triangle{0, 1, 2})) << face;
  }
}

TEST(ObjReader, CountsNegativeIndicesBackwardsFromTheFace) {
  const TriangleMesh mesh = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -1 -4 -2\n");
  EXPECT_EQ(mesh.triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(mesh.triangles[1], (Triangle{3, 0, 2}));
}

TEST(ObjReader, AllowsFacesBeforeTheirVertices) {
  EXPECT_EQ(parse("f 1 2 3\n" + kFourVertices).triangles[0], (Triangle{0, 1, 2}));
}

TEST(ObjReader, PassesOverWeightsAndColours) {
  const TriangleMesh mesh = parse("v 1 2 3 1\nv 4 5 6 0.1 0.2 0.3\nv 7 8 +9e0\nf 1 2 3\n");
  EXPECT_EQ(mesh.positions[0], Vec3(1, 2, 3));
  EXPECT_EQ(mesh.positions[1], Vec3(4, 5, 6));
  EXPECT_EQ(mesh.positions[2], Vec3(7, 8, 9));
}

TEST(ObjReader, TakesNumbersTooSmallForADoubleAsZero) {
  const std::string long_zero = "0." + std::string(400, '0') + "1";
  const TriangleMesh mesh =
      parse("v 1e-400 -1e-400 " + long_zero + "\nv 0.01e-323 1e-99999999999999999999 1\nv 1" +
            std::string(400, '0') + "e-400 " + long_zero + "e401 5e-324\nf 1 2 3\n");
  EXPECT_EQ(mesh.positions[0], Vec3::Zero());
  EXPECT_TRUE(std::signbit(mesh.positions[0].y()));
  EXPECT_EQ(mesh.positions[1], Vec3(0, 0, 1));
  EXPECT_EQ(mesh.positions[2], Vec3(1, 1, std::numeric_limits<double>::denorm_min()));
}

TEST(ObjReader, TakesAnyLayoutOfLines) {
  const std::vector<std::string> texts = {
      "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n",                 // Windows
      "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r",                         // old Macintosh
      "\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3",               // byte order mark, no end of line
      "\tv\t0\t0  0 \n\n  v 1 0 0\nv 0 1 0\n\n\nf\t1 2 3\t\n",        // blanks
      "v 0 \\\n0 0\nv 1 0 0\nv 0 1 0\nf 1 2\\\r\n \\\n 3\n",          // continued lines
      "# a\\\nv 0 0 0 # here\nv 1 0 0#\nv 0 1 0\nf 1 2 3 # f 9 9 9",  // comments
  };
  for (const std::string& text : texts) {
    const TriangleMesh mesh = parse(text);
    ASSERT_EQ(mesh.num_vertices(), 3) << text;
    EXPECT_EQ(mesh.positions[1], Vec3(1, 0, 0)) << text;
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}})) << text;
  }
}

TEST(ObjReader, KeepsPolygonsWithTheirTextureCoordinates) {
  const MeshFaces faces =
      parse_obj("vt 0 0\nvt 1 0\nvt 1 1\n" + kFourVertices + "f 4/1 1/2 2/3 3/1\nf 1 2 3\nf 3/3 1/1 2/2\n",
                "x.obj")
          .faces;
  ASSERT_EQ(faces.size(), 3u);
  EXPECT_EQ(faces.corners, (std::vector<int>{3, 0, 1, 2, 0, 1, 2, 2, 0, 1}));
  EXPECT_EQ(faces.ends, (std::vector<std::size_t>{4, 7, 10}));
  ASSERT_EQ(faces.uv.size(), 10u);
  EXPECT_EQ(faces.uv[2], Eigen::Vector2d(1, 1));
  for (const Eigen::Vector2d& corner : faces.uv_of(1)) EXPECT_TRUE(std::isnan(corner.x()));
  EXPECT_EQ(faces.uv_of(2)[2], Eigen::Vector2d(1, 0));

  const MeshFaces bare = parse_obj("vt 0 0\n" + kFourVertices + "f 1 2 3 4\n", "x.obj").faces;
  EXPECT_TRUE(bare.uv.empty());
  EXPECT_TRUE(bare.uv_of(0).empty());
}

TEST(ObjReader, ReadsTextureCoordinatesOfOneToThreeNumbers) {
  const MeshFaces faces =
      parse_obj("vt 0.5\nvt 0.25 0.75\nvt 1 2 3\nvt x 1\n" + kFourVertices + "f 1/1 2/2 3/3 4/4\n", "x.obj")
          .faces;
  ASSERT_EQ(faces.uv.size(), 4u);
  EXPECT_EQ(faces.uv[0], Eigen::Vector2d(0.5, 0));
  EXPECT_EQ(faces.uv[1], Eigen::Vector2d(0.25, 0.75));
  EXPECT_EQ(faces.uv[2], Eigen::Vector2d(1, 2));
  EXPECT_TRUE(std::isnan(faces.uv[3].x()) && std::isnan(faces.uv[3].y()));
}

TEST(ObjReader, KeepsGroupsAndObjects) {
  const auto groups_of = [](const std::string& text) {
    return parse_obj(kFourVertices + text, "x.obj").faces.groups;
  };
  const std::string face = "f 1 2 3\n";
  EXPECT_TRUE(groups_of(face).empty());
  EXPECT_EQ(groups_of("g front\n" + face + face), (std::vector<MeshGroup>{{"front", false, {{0, 2}}}}));
  // Several names on a line, one twice; a name that comes again; faces without a name; lines without faces.
  EXPECT_EQ(groups_of("g none\n" + face + "g\n" + face + "g b a a\n" + face + "g none\ng a\n" + face + "g\n" +
                      face + "g a c\n" + face + "g unused\n"),
            (std::vector<MeshGroup>{{"none", false, {{0, 1}}},
                                    {"b", false, {{2, 3}}},
                                    {"a", false, {{2, 4}, {5, 6}}},
                                    {"c", false, {{5, 6}}}}));
  // An object goes on over lines g, and a group over lines o. Equal names of both kinds are two groups.
  EXPECT_EQ(groups_of("g a\no a\n" + face + "g b\n" + face + "o my shirt\n" + face),
            (std::vector<MeshGroup>{{"a", true, {{0, 2}}},
                                    {"a", false, {{0, 1}}},
                                    {"b", false, {{1, 3}}},
                                    {"my shirt", true, {{2, 3}}}}));
}

TEST(ObjReader, NeedsNoMoreMemoryForGroupsThanTheFileHas) {
  std::string text = kFourVertices + "g";
  for (int k = 0; k < 2000; ++k) text += " name" + std::to_string(k);
  text += '\n';
  for (int k = 0; k < 2000; ++k) text += "f 1 2 3\n";
  const std::vector<MeshGroup> groups = parse_obj(text, "x.obj").faces.groups;
  ASSERT_EQ(groups.size(), 2000u);
  for (const MeshGroup& group : groups) EXPECT_EQ(group.faces, (std::vector<FaceRange>{{0, 2000}}));
}

TEST(ObjReader, KeepsLinesAsPairsOfVertices) {
  // Three vertices on a line, indices from the end and with texture coordinates, a vertex that comes later; mistakes.
  const std::string text =
      kFourVertices + "l 1 2 4\nl -1 1/1\nl 2 5\nl 1 9\nl 2 x 3\nl 3 3\nl 0 2\nv 5 5 5\nf 1 2 3\n";
  const MeshFromFile read = parse_obj(text, "x.obj");
  const std::vector<std::array<int, 2>> expected = {{0, 1}, {1, 3}, {3, 0}, {1, 4}};
  EXPECT_EQ(read.faces.lines, expected);
  EXPECT_TRUE(read.warnings.empty());
  EXPECT_EQ(parse_obj(obj_text(read.mesh.positions, read.faces), "y.obj").faces.lines, expected);
}

TEST(ObjReader, TellsUnknownKeywordsOnceAndStaysSilentOnKnownOnes) {
  const MeshFromFile known =
      parse_obj("mtllib a.mtl\no a\ng b\ns off\nusemtl c\nusemap d\nvn 0 0 1\nvt 0 0\n" + kFourVertices +
                    "f 1 2 3\nl 1 2\np 1\n",
                "x.obj");
  EXPECT_TRUE(known.warnings.empty());

  // As in the garment files of Berkeley: `t` is not a face, `vv` not a vertex.
  const MeshFromFile garment =
      parse_obj("v 0 0 0\nvv 0 0 0\nv 1 0 0\nvv 1 0 0\nv 0 1 0\nf 1 2 3\nt 0\n", "x.obj");
  EXPECT_TRUE(garment.warnings.empty());
  EXPECT_EQ(garment.mesh.num_vertices(), 3);
  EXPECT_EQ(garment.mesh.num_triangles(), 1);

  const MeshFromFile other = parse_obj("v 0 0 0\nw 0\nv 1 0 0\nw 0\nv 0 1 0\nf 1 2 3\ncurv 0\n", "x.obj");
  ASSERT_EQ(other.warnings.size(), 2u);
  EXPECT_EQ(other.warnings[0], "x.obj:7: unknown keyword 'curv' was ignored; it begins 1 lines");
  EXPECT_EQ(other.warnings[1], "x.obj:2: unknown keyword 'w' was ignored; it begins 2 lines");
}

TEST(ObjReader, TellsFewOfVeryManyUnknownKeywords) {
  std::string text = kFourVertices + "f 1 2 3\n";
  for (int k = 0; k < 1000; ++k) text += "word" + std::to_string(k) + "\n";
  EXPECT_EQ(parse_obj(text, "x.obj").warnings.size(), 9u);
}

// ---- Polygons ----

TEST(ObjReader, CutsQuadsAlongTheShorterDiagonal) {
  const TriangleMesh mesh = parse("v 0 0 0\nv 3 0 0\nv 4 1 0\nv 1 1 0\nf 1 2 3 4\n");
  ASSERT_EQ(mesh.num_triangles(), 2);
  for (const Triangle& triangle : mesh.triangles) {
    EXPECT_TRUE(std::find(triangle.begin(), triangle.end(), 1) != triangle.end());
    EXPECT_TRUE(std::find(triangle.begin(), triangle.end(), 3) != triangle.end());
  }
}

TEST(ObjReader, CutsAnArrowheadThroughItsNotchThoughThatIsTheLongerDiagonal) {
  const TriangleMesh mesh = parse("v 0 30 0\nv -2 -1 0\nv 0 0 0\nv 2 -1 0\nf 1 2 3 4\n");
  EXPECT_DOUBLE_EQ(total_area(mesh), 60);
}

TEST(ObjReader, CutsConcavePolygonsWithoutOverlapAnywhereInSpace) {
  std::mt19937 random(1);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  for (int trial = 0; trial < 500; ++trial) {
    const int n = 4 + trial % 9;
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(uniform() - 0.5, uniform() - 0.5, uniform() - 0.5, uniform()).normalized();
    const Vec3 offset(10 * uniform() - 5, 10 * uniform() - 5, 10 * uniform() - 5);
    std::vector<Vec3> corners;
    Vec3 area = Vec3::Zero();
    for (int k = 0; k < n; ++k) {  // a star with rays of random length
      const SinCos angle = sin_cos_deg(360.0 * (k + 0.3 * uniform()) / n);
      corners.push_back(offset + turn * (Vec3(angle.cos, angle.sin, 0) * (0.2 + uniform())));
    }
    for (int k = 0; k < n; ++k) area += 0.5 * (corners[k] - offset).cross(corners[(k + 1) % n] - offset);
    const TriangleMesh mesh = parse(polygon_text(corners));
    ASSERT_EQ(mesh.num_triangles(), n - 2);
    EXPECT_NEAR(total_area(mesh), area.norm(), 1e-12 * n);  // round-off; an overlap would add to it
  }
}

TEST(ObjReader, CutsPolygonsWithStraightCornersIntoTrianglesWithArea) {
  const TriangleMesh mesh = parse(
      "v 0 0 5\nv 1 0 5\nv 2 0 5\nv 2 1 5\nv 2 2 5\nv 1 2 5\nv 0 2 5\nv 0 1 5\n"
      "f 1 2 3 4 5 6 7 8\n");
  ASSERT_EQ(mesh.num_triangles(), 6);
  EXPECT_DOUBLE_EQ(total_area(mesh), 4);
  for (int t = 0; t < mesh.num_triangles(); ++t) EXPECT_GT(triangle_area(mesh, t), 0.1);
}

TEST(ObjReader, KeepsBothTextureCoordinatesOfAVertexThatAPolygonVisitsTwice) {
  // A square with a square hole, cut open between vertices 1 and 5; u is the number of the corner.
  std::string text =
      "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 1 1 0\nv 2 1 0\nv 2 2 0\nv 1 2 0\n"
      "f 1/1 2/2 3/3 4/4 1/5 5/6 8/7 7/8 6/9 5/10\n";
  for (int k = 0; k < 10; ++k) text += "vt " + std::to_string(k) + " 0\n";
  const MeshFromFile read = parse_obj(text, "x.obj");
  EXPECT_DOUBLE_EQ(total_area(read.mesh), 8);
  const std::array<int, 10> vertices = {0, 1, 2, 3, 0, 4, 7, 6, 5, 4};
  std::set<int> corners;
  for (std::size_t t = 0; t < read.uv.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      const int corner = static_cast<int>(read.uv[t][c].x());
      EXPECT_EQ(read.mesh.triangles[t][c], vertices[corner]);
      corners.insert(corner);
    }
  }
  EXPECT_EQ(corners.size(), 10u);
}

TEST(ObjReader, SurvivesPolygonsThatAreNone) {
  EXPECT_EQ(parse(kFourVertices + "f 1 1 1 1 1\n").num_triangles(), 3);    // one point
  EXPECT_EQ(parse(kFourVertices + "f 1 2 1 2 1 2\n").num_triangles(), 4);  // one edge
  EXPECT_EQ(parse(kFourVertices + "f 1 3 2 4\n").num_triangles(), 2);      // crosses itself
  EXPECT_EQ(parse("v 1e300 0 0\nv 0 1e300 0\nv 0 0 1e300\nv 1 1 1\nf 1 2 3 4").num_triangles(),
            2);  // overflow
}

// ---- Errors ----

TEST(ObjReader, NamesTheLineOfWhatItRefuses) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"v 0 0 0\nv 1 nan 0\n", "x.obj:2: 'nan' is not a coordinate; expected a finite number"},
      {"v 0 0 inf\n", "x.obj:1: 'inf'"},
      {"v 0 0 1e999\n", "x.obj:1: '1e999'"},
      {"v 0 0 1e99999999999999999999\n", "x.obj:1: '1e99999999999999999999'"},
      {"\n\nv 0 0 1,5\n", "x.obj:3: '1,5'"},
      {"v 0 0\n", "x.obj:1: a vertex with 2 coordinates; expected v X Y Z with three numbers"},
      {"v\n", "x.obj:1: a vertex with 0 coordinates"},
      {kFourVertices + "f 1 2\n", "x.obj:5: a face with 2 vertices; expected three or more"},
      {kFourVertices + "f 1 2 \\\n\n", "x.obj:5: a face with 2 vertices"},
      {kFourVertices + "f 1 2 5\n", "x.obj:5: vertex 5 does not exist; expected at most 4"},
      {kFourVertices + "f 1 2 -5\n", "x.obj:5: vertex -5 does not exist; 4 vertices come before this face"},
      {"v 0 0 \x80.\x01\n", "x.obj:1: '?.?' is not a coordinate"},
      {kFourVertices + "f 0 1 2\n", "x.obj:5: '0' is not a vertex of a face"},
      {kFourVertices + "f 1 2 x\n", "x.obj:5: 'x' is not a vertex of a face"},
      {kFourVertices + "f 1 2 /3\n", "x.obj:5: '/3' is not a vertex of a face"},
      {kFourVertices + "f 1 2 3.5\n", "x.obj:5: '3.5' is not a vertex of a face"},
      {kFourVertices + "f 1 2 4294967297\n", "x.obj:5: vertex 4294967297 does not exist"},
      {kFourVertices + "f 1 2 99999999999999999999\n", "x.obj:5: '99999999999999999999' is not a vertex"},
      {"", "x.obj: there are no vertices; expected lines v X Y Z"},
      {"solid stl\n", "x.obj: there are no vertices"},
      {kFourVertices, "x.obj: there are no faces; expected lines f A B C"},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(failure(text).rfind(message, 0), 0u) << failure(text);
}

TEST(ObjReader, RefusesFoldersAndMissingFiles) {
  EXPECT_THROW(read_obj(testing::TempDir()), InputError);
  EXPECT_THROW(read_obj(testing::TempDir() + "no_such_file.obj"), InputError);
}

TEST(ObjReader, EndsInAMeshOrAnInputErrorOnDamagedText) {
  const std::string sound =
      kFourVertices + "vn 0 0 1\nf 1 2 3\nf 1//1 2//1 3//1 4//1\nf -1 -2 -3 \\\n-4\no a\n";
  const std::string letters = "vf 0123456789-+./\\#\n\r\te\xEF\xFF";
  std::mt19937 random(1);
  int num_read = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    std::string text = sound;
    for (int k = 0; k < 1 + trial % 5; ++k) text[random() % text.size()] = letters[random() % letters.size()];
    try {
      const TriangleMesh mesh = parse(text);
      ++num_read;
      for (const Triangle& triangle : mesh.triangles) {
        for (const int v : triangle) ASSERT_TRUE(0 <= v && v < mesh.num_vertices()) << text;
      }
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(num_read, 500);  // the damage is often harmless
}

// ---- Writing ----

TEST(ObjWriter, WritesWhatReadsBackToTheLastBit) {
  TriangleMesh mesh;
  mesh.positions = {{0.1, -1.0 / 3, 1e-300}, {1e22, 2, 5e-324}, {0, 123456789.123456789, -7}};
  mesh.triangles = {{0, 1, 2}, {2, 1, 0}};
  const std::string file = (make_own_folder() / "round_trip.obj").string();
  write_obj(file, mesh);
  const MeshFromFile read = read_obj(file);
  EXPECT_EQ(read.mesh.positions, mesh.positions);
  EXPECT_EQ(read.mesh.triangles, mesh.triangles);
  EXPECT_TRUE(read.warnings.empty());
}

/// What the writer writes of it, read again.
MeshFromFile again(const MeshFromFile& mesh) {
  return parse_obj(obj_text(mesh.mesh.positions, mesh.faces), "again.obj");
}

TEST(ObjWriter, KeepsPolygonsTextureCoordinatesAndGroupsToTheLastBit) {
  std::mt19937 random(1);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  for (int trial = 0; trial < 200; ++trial) {
    std::string text;
    const int num_vertices = 5 + trial % 7;
    for (int v = 0; v < num_vertices; ++v) text += "v " + std::to_string(uniform()) + " 0 1e-5\n";
    for (int k = 0; k < 5; ++k) text += "vt 0." + std::to_string(random()) + (k == 0 ? " -0\n" : " 1e30\n");
    const std::array<std::string, 8> lines = {"g",   "g a", "g b a",         "g c",
                                              "o a", "o",   "o shirt  back", "g d d c"};
    for (int f = 0; f < 20; ++f) {
      if (random() % 3 == 0) text += lines[random() % lines.size()] + '\n';
      text += 'f';
      for (unsigned c = 0; c < 3 + random() % 4; ++c) {
        text += ' ' + std::to_string(1 + random() % num_vertices);
        if (trial % 3 > 0 && random() % 8 > 0) text += '/' + std::to_string(1 + random() % 5);
      }
      text += '\n';
    }
    const MeshFromFile read = parse_obj(text, "x.obj"), same = again(read);
    EXPECT_EQ(same.mesh.positions, read.mesh.positions);
    EXPECT_EQ(same.faces.corners, read.faces.corners);
    EXPECT_EQ(same.faces.ends, read.faces.ends);
    EXPECT_EQ(same.faces.groups, read.faces.groups) << text;
    ASSERT_EQ(same.faces.uv.size(), read.faces.uv.size());
    for (std::size_t c = 0; c < read.faces.uv.size(); ++c)
      EXPECT_EQ(bits_of(same.faces.uv[c]), bits_of(read.faces.uv[c]));
    EXPECT_EQ(same.mesh.triangles, read.mesh.triangles);
  }
}

TEST(ObjWriter, WritesWhatAnotherProgramWouldWrite) {
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 0.5 0\nvt 0.5 1\n"
      "o shirt\ng front\nf 1/1 2/2 3/3 4/1\ng front hem\nf 1/1 2/2 3/3\ng\nf 1 2 3\n";
  const MeshFromFile read = parse_obj(text, "x.obj");
  EXPECT_EQ(obj_text(read.mesh.positions, read.faces), text);
}

TEST(ObjWriter, RefusesNamesThatAFileCannotHold) {
  const std::string file = (make_own_folder() / "names.obj").string();
  const std::vector<Vec3> positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  MeshFaces faces = make_faces({{0, 1, 2}});
  for (const bool is_object : {false, true}) {
    for (const std::string name : {"", "a\nb", "a#b", "a\\", " a", "a\tb"}) {
      faces.groups = {{name, is_object, {{0, 1}}}};
      EXPECT_THROW(write_obj(file, positions, faces), InputError) << name;
    }
  }
  faces.groups = {{"a b", false, {{0, 1}}}};
  try {
    write_obj(file, positions, faces);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(),
              file + " cannot be written: an OBJ file has no name 'a b'; expected one word without # and \\");
  }
}

TEST(ObjWriter, CountsTheVerticesOfSeveralObjectsOn) {
  const TriangleMesh mesh = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string file = (make_own_folder() / "objects.obj").string();
  write_obj(file, {{"a", mesh}, {"b", mesh}});
  const MeshFromFile read = read_obj(file);
  EXPECT_EQ(read.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(read.faces.groups, (std::vector<MeshGroup>{{"a", true, {{0, 1}}}, {"b", true, {{1, 2}}}}));
}

TEST(ObjWriter, RefusesAFolderThatDoesNotExist) {
  EXPECT_THROW(write_obj(testing::TempDir() + "no_such_folder/x.obj", TriangleMesh{}), InputError);
}

}  // namespace
}  // namespace weft::engine
