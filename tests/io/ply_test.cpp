/// PLY files of every encoding and type are read. Written ones are read back bit by bit. Damaged ones are
/// refused with the place of the damage.

#include "weft/io/ply.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "tests/own_folder.h"
#include "tests/read_text.h"
#include "weft/core/random.h"
#include "weft/error.h"
#include "weft/io/obj_reader.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

const std::string kTextHeader =
    "ply\nformat ascii 1.0\n"
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kFourVertices = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

/// Bytes of a string literal, zeros included.
template <std::size_t n>
std::string bytes(const char (&literal)[n]) {
  return {literal, n - 1};
}

std::string reversed(std::string text) {
  std::reverse(text.begin(), text.end());
  return text;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

MeshFromFile parse(const std::string& text) { return parse_ply(text, "x.ply"); }

/// The error message for these bytes; every message is one line that begins with the file.
std::string failure(const std::string& text) {
  try {
    parse(text);
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with("x.ply:")) << message;
    EXPECT_EQ(message.find('\n'), message.npos) << message;
    return message;
  }
  return "no error";
}

void expect_failures(const std::vector<std::pair<std::string, std::string>>& cases) {
  for (const auto& [text, message] : cases) EXPECT_EQ(failure(text), message) << text;
}

bool have_same_bits(const Vec3& a, const Vec3& b) {
  for (int k = 0; k < 3; ++k) {
    if (std::bit_cast<std::uint64_t>(a[k]) != std::bit_cast<std::uint64_t>(b[k])) return false;
  }
  return true;
}

// ---- Encodings and types ----

TEST(PlyReader, ReadsText) {
  const MeshFromFile read = parse(kTextHeader + "0.1 -2e3 +3\n1 0 0\n1 1 0\n0 1 0\n3 2 1 3\n");
  ASSERT_EQ(read.mesh.num_vertices(), 4);
  EXPECT_EQ(read.mesh.positions[0], Vec3(0.1, -2000, 3));  // all digits, though the type is float
  EXPECT_EQ(read.mesh.positions[3], Vec3(0, 1, 0));
  EXPECT_EQ(read.mesh.triangles, (std::vector<Triangle>{{2, 1, 3}}));
  EXPECT_TRUE(read.uv.empty());
  EXPECT_TRUE(read.warnings.empty());
}

TEST(PlyReader, ReadsEveryScalarTypeInEveryEncoding) {
  struct Case {
    std::string name, sized_name;
    std::string bytes;  // big-endian
    double value;
    std::string word;
  };
  const std::vector<Case> cases = {
      {"char", "int8", bytes("\xFE"), -2, "-2"},
      {"uchar", "uint8", bytes("\xFE"), 254, "254"},
      {"short", "int16", bytes("\xFE\xDC"), -292, "-292"},
      {"ushort", "uint16", bytes("\xFE\xDC"), 65244, "65244"},
      {"int", "int32", bytes("\xFE\xDC\xBA\x98"), -19088744, "-19088744"},
      {"uint", "uint32", bytes("\xFE\xDC\xBA\x98"), 4275878552, "4275878552"},
      {"float", "float32", bytes("\xC0\x49\x0F\xDB"), -3.14159274101257324, "-3.14159274101257324"},
      {"double", "float64", bytes("\x40\x09\x21\xFB\x54\x44\x2D\x18"), 3.141592653589793,
       "3.141592653589793"},
  };
  for (const Case& c : cases) {
    for (const std::string& name : {c.name, c.sized_name}) {
      for (const std::string encoding : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        const std::string header = "ply\nformat " + encoding + " 1.0\nelement vertex 3\nproperty " + name +
                                   " x\nproperty uchar y\nproperty " + name +
                                   " z\nelement face 1\nproperty list uchar uchar vertex_index\nend_header\n";
        const std::string x = encoding == "ascii"               ? c.word
                              : encoding == "binary_big_endian" ? c.bytes
                                                                : reversed(c.bytes);
        const std::string row = encoding == "ascii" ? x + " 7 " + x + '\n' : x + '\7' + x;
        const std::string face = encoding == "ascii" ? "3 0 1 2\n" : bytes("\3\0\1\2");
        const MeshFromFile read = parse(header + row + row + row + face);
        ASSERT_EQ(read.mesh.num_vertices(), 3);
        for (const Vec3& position : read.mesh.positions)
          EXPECT_EQ(position, Vec3(c.value, 7, c.value)) << name << ' ' << encoding;
        EXPECT_EQ(read.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
      }
    }
  }
}

TEST(PlyReader, ReadsListsOfEveryCountAndIndexType) {
  const std::vector<std::pair<std::string, std::size_t>> types = {{"char", 1},   {"uint8", 1}, {"int16", 2},
                                                                  {"ushort", 2}, {"int", 4},   {"uint32", 4}};
  const auto whole = [](int value, std::size_t size, bool is_big) {
    const std::string big = std::string(size - 1, '\0') + static_cast<char>(value);
    return is_big ? big : reversed(big);
  };
  for (const auto& [count_type, count_size] : types) {
    for (const auto& [type, size] : types) {
      for (const bool is_big : {false, true}) {
        std::string text =
            "ply\nformat binary_" + std::string(is_big ? "big" : "little") +
            "_endian 1.0\nelement vertex 4\nproperty char x\nproperty char y\nproperty char z\n" +
            "element face 2\nproperty list " + count_type + ' ' + type + " vertex_indices\nend_header\n" +
            bytes("\0\0\0\1\0\0\1\1\0\0\1\0");
        text += whole(3, count_size, is_big);
        for (const int v : {3, 1, 2}) text += whole(v, size, is_big);
        text += whole(4, count_size, is_big);
        for (const int v : {0, 1, 2, 3}) text += whole(v, size, is_big);
        const TriangleMesh mesh = parse(text).mesh;
        ASSERT_EQ(mesh.num_triangles(), 3);
        EXPECT_EQ(mesh.triangles[0], (Triangle{3, 1, 2}));
      }
    }
  }
}

TEST(PlyReader, TakesElementsAndPropertiesInAnyOrderAndPassesOverOthers) {
  const std::string elements =
      "element face 2\nproperty uchar flags\nproperty list uchar short vertex_indices\nproperty list int "
      "double weights\n"
      "element empty 9\n"
      "element edge 2\nproperty list uchar char ends\nproperty float length\n"
      "element vertex 3\nproperty uchar red\nproperty short z\nproperty list uchar uchar groups\nproperty "
      "short "
      "x\nproperty short y\n"
      "element material 1\nproperty double gloss\nend_header\n";
  const std::string text = "ply\nformat ascii 1.0\n" + elements +
                           "8 3 0 1 2 0\n9 3 2 1 0 2 0.5 0.5\n"
                           "2 0 1 0.5\n0 0.5\n"
                           "255 3 0 1 2\n255 6 2 7 7 4 5\n255 9 1 7 7 8\n"
                           "0.5\n";
  const std::string binary = "ply\nformat binary_big_endian 1.0\n" + elements +
                             bytes(
                                 "\x8\3\0\0\0\1\0\2\0\0\0\0"
                                 "\x9\3\0\2\0\1\0\0\0\0\0\2\x3F\xE0\0\0\0\0\0\0\x3F\xE0\0\0\0\0\0\0"
                                 "\2\0\1\x3F\0\0\0"
                                 "\0\x3F\0\0\0"
                                 "\xFF\0\3\0\0\1\0\2"
                                 "\xFF\0\6\2\7\7\0\4\0\5"
                                 "\xFF\0\x9\1\7\0\7\0\x8"
                                 "\x3F\xE0\0\0\0\0\0\0");
  for (const std::string& file : {text, binary}) {
    const MeshFromFile read = parse(file);
    ASSERT_EQ(read.mesh.num_vertices(), 3);
    EXPECT_EQ(read.mesh.positions[0], Vec3(1, 2, 3));
    EXPECT_EQ(read.mesh.positions[1], Vec3(4, 5, 6));
    EXPECT_EQ(read.mesh.positions[2], Vec3(7, 8, 9));
    EXPECT_EQ(read.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 0}}));
    EXPECT_TRUE(read.warnings.empty());
  }
}

TEST(PlyReader, TakesCommentsBlankLinesAndBothLineEnds) {
  std::string text =
      "ply\ncomment format ascii 9\nformat ascii 1.0\nobj_info made by hand\n\n"
      "element vertex 3\n  property\tfloat  x\nproperty float y\ncomment\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n\n1\t0 0 \n0 1 0\n3 0 1 2";
  std::string crlf;
  for (const char c : text) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  for (const std::string& file : {text, text + "\n \n", crlf, crlf + "\r\n\r\n"}) {
    const MeshFromFile read = parse(file);
    EXPECT_EQ(read.mesh.positions[1], Vec3(1, 0, 0));
    EXPECT_EQ(read.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_TRUE(read.warnings.empty());
  }
}

TEST(PlyReader, TakesBinaryDataBehindBothLineEnds) {
  // The first byte of the data is a line feed.
  for (const std::string end : {"\n", "\r\n"}) {
    const MeshFromFile read =
        parse("ply" + end + "format binary_little_endian 1.0" + end + "element vertex 3" + end +
              "property char x" + end + "property char y" + end + "property char z" + end + "element face 1" +
              end + "property list uchar uchar vertex_indices" + end + "end_header" + end +
              bytes("\n\r\0\1\0\0\0\1\0\3\0\1\2"));
    EXPECT_EQ(read.mesh.positions[0], Vec3(10, 13, 0));
  }
}

TEST(PlyReader, WarnsOfBytesBehindTheLastElement) {
  const std::string text = kTextHeader + kFourVertices + "3 0 1 2\n";
  EXPECT_EQ(parse(text + "3 2 3 0\n").warnings,
            std::vector<std::string>{"x.ply: 8 bytes behind the last element were ignored"});
}

// ---- Polygons and texture coordinates ----

TEST(PlyReader, CutsPolygonsAsTheObjReaderDoes) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 3 + trial % 10;
    std::string vertices, obj, ply_face = std::to_string(n), obj_face = "f";
    for (int k = 0; k < n; ++k) {  // crosses itself too
      std::string position;
      for (int axis = 0; axis < 3; ++axis) position += ' ' + std::to_string(random.uniform(-1, 1));
      vertices += position + '\n';
      obj += 'v' + position + '\n';
      ply_face += ' ' + std::to_string(k);
      obj_face += ' ' + std::to_string(k + 1);
    }
    const std::string header = replaced(kTextHeader, "vertex 4", "vertex " + std::to_string(n));
    const TriangleMesh mesh = parse(header + vertices + ply_face + '\n').mesh;
    const TriangleMesh expected = parse_obj(obj + obj_face, "x.obj").mesh;
    EXPECT_EQ(mesh.positions, expected.positions);
    EXPECT_EQ(mesh.triangles, expected.triangles);
  }
}

TEST(PlyReader, ReadsTextureCoordinatesOfVertices) {
  for (const auto& [u, v] :
       std::vector<std::pair<std::string, std::string>>{{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}}) {
    const std::string header =
        replaced(kTextHeader, "property float x\n",
                 "property float " + v + "\nproperty float x\nproperty double " + u + '\n');
    const MeshFromFile read =
        parse(header + "0.5 0 0.25 0 0\n1 1 2 0 0\n3 1 4 1 0\n5 0 nan 1 0\n4 0 1 2 3\n");
    ASSERT_EQ(read.uv.size(), 2u);
    const std::array<Eigen::Vector2d, 3> expected = {{{0.25, 0.5}, {2, 1}, {4, 3}}};
    for (std::size_t t = 0; t < 2; ++t) {
      for (int c = 0; c < 3; ++c) {
        const int vertex = read.mesh.triangles[t][c];
        const Eigen::Vector2d uv = read.uv[t][c];
        if (vertex == 3) {
          EXPECT_TRUE(std::isnan(uv.x()) && std::isnan(uv.y()));  // half of a pair is none
        } else {
          EXPECT_EQ(uv, expected[vertex]);
        }
      }
    }
  }
}

TEST(PlyReader, RefusesAnIndexThatDoesNotExistBeforeItsTextureCoordinatesAreRead) {
  const std::string header =
      replaced(kTextHeader, "property float x\n", "property float x\nproperty float s\nproperty float t\n");
  EXPECT_EQ(
      failure(header + "0 0 0 0 0\n1 0 0 0 0\n1 0 0 1 0\n0 0 0 1 0\n3 0 1 1000000\n"),
      "x.ply:16: row 0 of 'face', property 'vertex_indices': vertex 1000000 does not exist; expected 0 to 3");
}

TEST(PlyReader, HalfAPairIsNoTextureCoordinate) {
  const std::string header =
      replaced(kTextHeader, "property float x\n", "property float x\nproperty float s\n");
  EXPECT_TRUE(parse(header + "0 0 0 0\n1 0 0 0\n1 0 1 0\n0 0 1 0\n3 0 1 2\n").uv.empty());
}

const std::string kCornerHeader = replaced(
    replaced(kTextHeader, "vertex_indices\n", "vertex_indices\nproperty list uchar float texcoord\n"),
    "face 1", "face 3");

TEST(PlyReader, ReadsTextureCoordinatesOfCorners) {
  const MeshFromFile read =
      parse(kCornerHeader + kFourVertices + "3 0 1 2 6 0 1 2 3 4 5\n3 0 2 3 0\n3 3 1 0 6 6 7 nan 8 inf 9\n");
  ASSERT_EQ(read.uv.size(), 3u);
  EXPECT_EQ(read.uv[0], (CornerUv{Eigen::Vector2d(0, 1), Eigen::Vector2d(2, 3), Eigen::Vector2d(4, 5)}));
  for (const Eigen::Vector2d& corner : read.uv[1]) EXPECT_TRUE(std::isnan(corner.x()));
  EXPECT_EQ(read.uv[2][0], Eigen::Vector2d(6, 7));
  for (int c = 1; c < 3; ++c) EXPECT_TRUE(std::isnan(read.uv[2][c].x()) && std::isnan(read.uv[2][c].y()));
}

TEST(PlyReader, CornersReplaceTheTextureCoordinatesOfVertices) {
  const std::string header =
      replaced(kCornerHeader, "property float z\n", "property float z\nproperty float u\nproperty float v\n");
  const MeshFromFile read = parse(header +
                                  "0 0 0 10 11\n1 0 0 20 21\n1 1 0 30 31\n0 1 0 40 41\n"
                                  "3 0 1 2 6 0 1 2 3 4 5\n3 0 2 3 0\n3 3 1 0 0\n");
  EXPECT_EQ(read.uv[0][1], Eigen::Vector2d(2, 3));
  EXPECT_EQ(read.uv[1][2], Eigen::Vector2d(40, 41));
}

TEST(PlyReader, ListsWithoutTextureCoordinatesAreNone) {
  EXPECT_TRUE(parse(kCornerHeader + kFourVertices + "3 0 1 2 0\n3 0 2 3 0\n3 0 1 2 6 nan 0 nan 0 nan 0\n")
                  .uv.empty());
}

// ---- Damage ----

TEST(PlyReader, NamesTheLineOfAMistakeInTheHeader) {
  const std::string data = kFourVertices + "3 0 1 2\n";
  const auto with = [&](const std::string& from, const std::string& to) {
    return replaced(kTextHeader, from, to) + data;
  };
  expect_failures({
      {"", "x.ply:1: expected ply, the first line of a PLY file"},
      {"solid ply\n", "x.ply:1: expected ply, the first line of a PLY file"},
      {with("ply\n", "ply 1\n"), "x.ply:1: expected ply, the first line of a PLY file"},
      {with("ascii 1.0", "ascii"), "x.ply:2: expected format KIND 1.0"},
      {with("ascii 1.0", "ascii 1.1"), "x.ply:2: expected format KIND 1.0"},
      {with("ascii", "binary"),
       "x.ply:2: 'binary' is not a format; expected ascii, binary_little_endian or binary_big_endian"},
      {with("format ascii 1.0\n", ""), "x.ply:8: the header ends without a line format KIND 1.0"},
      {with("vertex 4", "vertex"), "x.ply:3: expected element NAME COUNT"},
      {with("vertex 4", "vertex -1"),
       "x.ply:3: '-1' is not a number of rows; expected a whole number from 0 to 2147483647"},
      {with("vertex 4", "vertex 2147483648"),
       "x.ply:3: '2147483648' is not a number of rows; expected a whole number from 0 to 2147483647"},
      {with("vertex 4", "vertex 4.5"),
       "x.ply:3: '4.5' is not a number of rows; expected a whole number from 0 to 2147483647"},
      {with("vertex 4", "vertex nan"),
       "x.ply:3: 'nan' is not a number of rows; expected a whole number from 0 to 2147483647"},
      {with("element face", "element vertex"), "x.ply:7: element 'vertex' is defined a second time"},
      {with("property float y", "property float x"), "x.ply:5: property 'x' is defined a second time"},
      {with("property float y", "property y"),
       "x.ply:5: expected property TYPE NAME or property list COUNT_TYPE TYPE NAME"},
      {with("property float y", "property list int y"),
       "x.ply:5: expected property TYPE NAME or property list COUNT_TYPE TYPE NAME"},
      {with("property float y", "property"),
       "x.ply:5: expected property TYPE NAME or property list COUNT_TYPE TYPE NAME"},
      {with("property float y", "property long y"),
       "x.ply:5: 'long' is not a type; expected char, uchar, short, ushort, int, uint, float or double"},
      {with("uchar int", "float int"), "x.ply:8: 'float' cannot count a list; expected a whole type"},
      {with("uchar int", "list int"),
       "x.ply:8: 'list' is not a type; expected char, uchar, short, ushort, int, uint, float or double"},
      {with("element vertex 4\n", ""), "x.ply:3: a property before the first element"},
      {with("element vertex 4\n", "vertex 4\n"),
       "x.ply:3: unknown keyword 'vertex'; expected format, element, property, comment, obj_info or "
       "end_header"},
      {with("end_header\n", ""),
       "x.ply:9: unknown keyword '0'; expected format, element, property, comment, obj_info or end_header"},
      {"ply\nformat ascii 1.0\n", "x.ply:2: the file ends in the header; expected end_header"},
      {with("element vertex", "element point"), "x.ply: there are no vertices; expected an element vertex"},
      {with("element face", "element tristrips"), "x.ply: there are no faces; expected an element face"},
      {with("float y", "float Y"), "x.ply:3: a vertex without coordinates; expected properties x, y and z"},
      {replaced(kTextHeader, "float z", "list uchar float z") + "0 0 0\n0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n",
       "x.ply:3: a vertex without coordinates; expected properties x, y and z"},
      {with("vertex_indices", "indices"),
       "x.ply:7: a face without vertices; expected a list vertex_indices of a whole type"},
      {with("uchar int", "uchar float"),
       "x.ply:7: a face without vertices; expected a list vertex_indices of a whole type"},
  });
}

TEST(PlyReader, NamesTheLineOfAMistakeInText) {
  const auto with = [](const std::string& vertices, const std::string& face) {
    return kTextHeader + vertices + face;
  };
  expect_failures({
      {with("0 0 0\n1 nan 0\n1 1 0\n0 1 0\n", "3 0 1 2"),
       "x.ply:11: row 1 of 'vertex', property 'y': the coordinate is not a finite number"},
      {with("0 0 0\n1 0 inf\n1 1 0\n0 1 0\n", "3 0 1 2"),
       "x.ply:11: row 1 of 'vertex', property 'z': the coordinate is not a finite number"},
      {with("1,5 0 0\n1 0 0\n1 1 0\n0 1 0\n", "3 0 1 2"),
       "x.ply:10: row 0 of 'vertex', property 'x': '1,5' is not a number of type float"},
      {with("1e999 0 0\n1 0 0\n1 1 0\n0 1 0\n", "3 0 1 2"),
       "x.ply:10: row 0 of 'vertex', property 'x': '1e999' is not a number of type float"},
      {with("0 0\n1 0 0\n1 1 0\n0 1 0\n", "3 0 1 2"),
       "x.ply:10: row 0 of 'vertex', property 'z': expected 1 numbers, but the line has 0 more"},
      {with("0 0 0 0\n1 0 0\n1 1 0\n0 1 0\n", "3 0 1 2"),
       "x.ply:10: row 0 of 'vertex' has 4 numbers; expected 3"},
      {with("0 0 0\n1 0 0\n", ""), "x.ply:11: row 2 of 'vertex' is missing; expected 4 rows"},
      {with(kFourVertices, ""), "x.ply:13: row 0 of 'face' is missing; expected 1 rows"},
      {with(kFourVertices, "4 0 1 2"),
       "x.ply:14: row 0 of 'face', property 'vertex_indices': expected 4 numbers, but the line has 3 more"},
      {with(kFourVertices, "3 0 1 2 3"), "x.ply:14: row 0 of 'face' has 5 numbers; expected 4"},
      {with(kFourVertices, "2 0 1"),
       "x.ply:14: row 0 of 'face', property 'vertex_indices': a face with 2 vertices; expected three or "
       "more"},
      {with(kFourVertices, "0"),
       "x.ply:14: row 0 of 'face', property 'vertex_indices': a face with 0 vertices; expected three or "
       "more"},
      {with(kFourVertices, "3 0 1 4"),
       "x.ply:14: row 0 of 'face', property 'vertex_indices': vertex 4 does not exist; expected 0 to 3"},
      {with(kFourVertices, "3 0 -1 2"),
       "x.ply:14: row 0 of 'face', property 'vertex_indices': vertex -1 does not exist; expected 0 to 3"},
      {with(kFourVertices, "3 0 1.5 2"),
       "x.ply:14: row 0 of 'face', property 'vertex_indices': '1.5' is not a number of type int"},
      {with(kFourVertices, "3 0 1 4294967297"),
       "x.ply:14: row 0 of 'face', property 'vertex_indices': '4294967297' is not a number of type int"},
      {with(kFourVertices, "-3 0 1 2"),
       "x.ply:14: row 0 of 'face', property 'vertex_indices': '-3' is not a number of type uchar"},
      {with(kFourVertices, "256 0 1 2"),
       "x.ply:14: row 0 of 'face', property 'vertex_indices': '256' is not a number of type uchar"},
      {replaced(kTextHeader, "uchar", "char") + kFourVertices + "-3 0 1 2",
       "x.ply:14: row 0 of 'face', property 'vertex_indices': a list of -3 numbers; expected 0 or more"},
      {replaced(kTextHeader, "uchar", "uint") + kFourVertices + "2147483648 0 1 2",
       "x.ply:14: row 0 of 'face', property 'vertex_indices': expected 2147483648 numbers, but the line has "
       "3 "
       "more"},
      {replaced(kTextHeader, "vertex 4", "vertex 2147483647") + kFourVertices,
       "x.ply:13: row 4 of 'vertex' is missing; expected 2147483647 rows"},
      {kCornerHeader + kFourVertices + "3 0 1 2 6 0 1 2 3 4 5\n3 0 1 2 5 0 1 2 3 4\n3 0 1 2 0\n",
       "x.ply:16: row 1 of 'face', property 'texcoord': a list of 5 numbers; expected 6, two for each vertex "
       "of "
       "the face"},
  });
}

/// Three vertices and a triangle in big-endian floats and ints: three rows of 12 bytes and one of 16.
const std::string kBinaryHeader =
    "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "element face 1\nproperty list int int vertex_index\nend_header\n";
const std::string kBinaryData = bytes(
    "\0\0\0\0\0\0\0\0\0\0\0\0"
    "\x3F\x80\0\0\0\0\0\0\0\0\0\0"
    "\0\0\0\0\x3F\x80\0\0\x80\0\0\0"
    "\0\0\0\3\0\0\0\0\0\0\0\1\0\0\0\2");

TEST(PlyReader, NamesTheByteOfAMistakeInBinaryData) {
  const std::size_t begin = kBinaryHeader.size();
  const auto with = [](std::size_t at, const std::string& word) {
    return kBinaryHeader + std::string(kBinaryData).replace(at, 4, word);
  };
  const auto place = [&](std::size_t at) { return "x.ply: byte " + std::to_string(begin + at) + ": "; };
  const TriangleMesh good = parse(kBinaryHeader + kBinaryData).mesh;
  EXPECT_EQ(good.positions[1], Vec3(1, 0, 0));
  EXPECT_TRUE(have_same_bits(good.positions[2], Vec3(0, 1, -0.0)));
  expect_failures({
      {with(16, bytes("\x7F\xC0\0\0")),
       place(16) + "row 1 of 'vertex', property 'y': the coordinate is not a finite number"},
      {with(32, bytes("\xFF\x80\0\0")),
       place(32) + "row 2 of 'vertex', property 'z': the coordinate is not a finite number"},
      {with(36, bytes("\xFF\xFF\xFF\xFF")),
       place(36) + "row 0 of 'face', property 'vertex_index': a list of -1 numbers; expected 0 or more"},
      {with(36, bytes("\x80\0\0\0")),
       place(36) +
           "row 0 of 'face', property 'vertex_index': a list of -2147483648 numbers; expected 0 or more"},
      {with(36, bytes("\x7F\xFF\xFF\xFF")),
       place(40) +
           "row 0 of 'face', property 'vertex_index': expected 2147483647 numbers, but the file has 3 more"},
      {replaced(with(36, bytes("\x80\0\0\0")), "list int", "list uint"),
       place(41) +
           "row 0 of 'face', property 'vertex_index': expected 2147483648 numbers, but the file has 3 "
           "more"},
      {with(36, bytes("\0\0\0\2")),
       place(40) +
           "row 0 of 'face', property 'vertex_index': a face with 2 vertices; expected three or more"},
      {with(48, bytes("\0\0\0\3")),
       place(48) + "row 0 of 'face', property 'vertex_index': vertex 3 does not exist; expected 0 to 2"},
      {with(44, bytes("\x80\0\0\0")),
       place(44) +
           "row 0 of 'face', property 'vertex_index': vertex -2147483648 does not exist; expected 0 to 2"},
      {replaced(with(40, bytes("\xFF\xFF\xFF\xFF")), "int vertex_index", "uint vertex_index"),
       place(41) +
           "row 0 of 'face', property 'vertex_index': vertex 4294967295 does not exist; expected 0 to 2"},
  });
}

TEST(PlyReader, CountsThatTheFileCannotHoldAreRefused) {
  const std::string many = "2147483647";
  const auto ends = [](const std::string& header, std::size_t num_bytes, const std::string& what) {
    return "x.ply: byte " + std::to_string(header.size() + num_bytes) + ": row " + what +
           ": expected 1 numbers, but the file has 0 more";
  };
  const std::string vertices = replaced(kBinaryHeader, "vertex 3", "vertex " + many);
  EXPECT_EQ(failure(vertices + kBinaryData), ends(vertices, 52, "4 of 'vertex', property 'y'"));
  const std::string faces = replaced(kBinaryHeader, "face 1", "face " + many);
  EXPECT_EQ(failure(faces + kBinaryData), ends(faces, 52, "1 of 'face', property 'vertex_index'"));
  const std::string others = replaced(kBinaryHeader, "end_header",
                                      "element other " + many + "\nproperty list uchar double a\nend_header");
  EXPECT_EQ(failure(others + kBinaryData + bytes("\0\0")), ends(others, 54, "2 of 'other', property 'a'"));
  // Rows without properties have no data.
  const std::string empty = replaced(kBinaryHeader, "end_header", "element empty " + many + "\nend_header");
  EXPECT_EQ(parse(empty + kBinaryData).mesh.num_triangles(), 1);
}

TEST(PlyReader, TruncatedFileIsRefusedAtEveryLength) {
  const std::string good = kBinaryHeader + kBinaryData;
  for (std::size_t length = 0; length < good.size(); ++length) {
    const std::string message = failure(good.substr(0, length));
    const std::string place = length + 1 < kBinaryHeader.size() ? "x.ply:" : "x.ply: byte ";
    EXPECT_TRUE(message.starts_with(place)) << length << ": " << message;
  }
}

TEST(PlyReader, RefusesFoldersAndMissingFiles) {
  EXPECT_THROW(read_ply(testing::TempDir()), InputError);
  EXPECT_THROW(read_ply(testing::TempDir() + "no_such_file.ply"), InputError);
}

TEST(PlyReader, EndsInAMeshOrAnInputErrorOnDamagedBytes) {
  const std::vector<std::string> sound = {
      kTextHeader + kFourVertices + "4 0 1 2 3\n",
      kCornerHeader + kFourVertices + "3 0 1 2 6 0 1 2 3 4 5\n3 0 2 3 0\n4 0 1 2 3 0\n",
      kBinaryHeader + kBinaryData};
  std::mt19937 random(1);
  int num_read = 0;
  for (int trial = 0; trial < 15000; ++trial) {
    const std::string& original = sound[trial % 3];
    const bool is_binary = trial % 3 == 2;
    const std::size_t begin = trial % 2 == 0 ? 0 : original.find("end_header\n") + 11;  // everything, or data
    std::string text = original;
    for (int k = 0; k < 1 + trial % 5; ++k)
      text[begin + random() % (text.size() - begin)] =
          is_binary ? static_cast<char>(random()) : original[random() % text.size()];
    try {
      const MeshFromFile read = parse(text);
      ++num_read;
      for (const Vec3& position : read.mesh.positions) ASSERT_TRUE(position.allFinite());
      for (const Triangle& triangle : read.mesh.triangles) {
        for (const int v : triangle) ASSERT_TRUE(0 <= v && v < read.mesh.num_vertices());
      }
      ASSERT_TRUE(read.uv.empty() || read.uv.size() == read.mesh.triangles.size());
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(num_read, 500);  // the damage is often harmless
}

// ---- Writing ----

class PlyWriter : public testing::Test {
 protected:
  std::string written() const { return read_text(file_); }

  const fs::path file_ = make_own_folder() / "mesh.ply";
};

/// Any finite number: every bit is random.
double random_number(Random& random) {
  while (true) {
    const double number = std::bit_cast<double>(random.next());
    if (std::isfinite(number)) return number;
  }
}

std::vector<Vec3> random_positions(Random& random, int count) {
  std::vector<Vec3> positions;
  for (int v = 0; v < count; ++v)
    positions.emplace_back(random_number(random), random_number(random), random_number(random));
  return positions;
}

int random_index(Random& random, int count) {
  return static_cast<int>(random.next() % static_cast<std::uint64_t>(count));
}

TEST_F(PlyWriter, HasTheFormatsBytes) {
  const TriangleMesh mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, -2, 0.5}}, .triangles = {{0, 1, 2}}};
  write_ply(file_, mesh.positions, make_faces(mesh.triangles), PlyNumbers::floats);
  EXPECT_EQ(written(),
            "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n" +
                bytes("\0\0\0\0\0\0\0\0\0\0\0\0"
                      "\0\0\x80\x3F\0\0\0\0\0\0\0\0"
                      "\0\0\0\0\0\0\0\xC0\0\0\0\x3F"
                      "\3\0\0\0\0\1\0\0\0\2\0\0\0"));
  write_ply(file_, mesh.positions, make_faces({{2, 1, 0}}, {{Eigen::Vector2d(0, 1), {0, 0}, {-2, 0}}}));
  EXPECT_EQ(written(),
            "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
            "property double z\nproperty double s\nproperty double t\nelement face 1\n"
            "property list uchar int vertex_indices\nend_header\n" +
                bytes("\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"
                      "\0\0\0\0\0\0\0\xC0\0\0\0\0\0\0\0\0"
                      "\0\0\0\0\0\0\xF0\x3F\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"
                      "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"
                      "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\xC0\0\0\0\0\0\0\xE0\x3F"
                      "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\xF0\x3F"
                      "\3\2\0\0\0\1\0\0\0\0\0\0\0"));
  MeshFaces seam = make_faces({{2, 1, 0}, {0, 1, 2}});
  seam.uv = {{0, 1}, {0, 0}, {-2, 0}, {-2, 0}, {0, 0}, {0, 3}};
  write_ply(file_, mesh.positions, seam, PlyNumbers::floats);
  EXPECT_TRUE(written().starts_with(
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
      "property list uchar float texcoord\nend_header\n"));
  EXPECT_TRUE(
      written().ends_with(bytes("\3\0\0\0\0\1\0\0\0\2\0\0\0"
                                "\6\0\0\0\xC0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x40\x40")));
}

TEST_F(PlyWriter, KeepsEveryBitOfATriangleMesh) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const int num_vertices = 3 + trial;
    TriangleMesh mesh{.positions = random_positions(random, num_vertices), .triangles = {}};
    std::vector<CornerUv> uv;
    for (int t = 0; t < 2 * trial + 1; ++t) {
      Triangle& triangle = mesh.triangles.emplace_back();
      CornerUv& corners = uv.emplace_back();
      for (int c = 0; c < 3; ++c) {
        triangle[c] = random_index(random, num_vertices);
        corners[c] = {random_number(random), random_number(random)};
      }
    }
    if (trial % 2 == 0) uv.clear();
    write_ply(file_, mesh.positions, make_faces(mesh.triangles, uv));
    const MeshFromFile read = read_ply(file_);
    ASSERT_EQ(read.mesh.num_vertices(), num_vertices);
    for (int v = 0; v < num_vertices; ++v)
      EXPECT_TRUE(have_same_bits(read.mesh.positions[v], mesh.positions[v]));
    EXPECT_EQ(read.mesh.triangles, mesh.triangles);
    ASSERT_EQ(read.uv.size(), uv.size());
    for (std::size_t t = 0; t < uv.size(); ++t) {
      for (int c = 0; c < 3; ++c)
        EXPECT_TRUE(
            have_same_bits({read.uv[t][c].x(), read.uv[t][c].y(), 0}, {uv[t][c].x(), uv[t][c].y(), 0}));
    }
    EXPECT_TRUE(read.warnings.empty());
  }
}

TEST_F(PlyWriter, KeepsEveryBitOfTextureCoordinatesByVertex) {
  Random random(1);
  std::vector<Vec3> positions = random_positions(random, 6);
  std::vector<Eigen::Vector2d> vertex_uv;
  for (int v = 0; v < 6; ++v) vertex_uv.emplace_back(random_number(random), random_number(random));
  MeshFaces faces;
  for (const std::vector<int>& polygon : {std::vector<int>{0, 1, 2, 3, 4}, {4, 3, 0}}) {  // the last is free
    std::vector<Eigen::Vector2d> corners;
    for (const int v : polygon) corners.push_back(vertex_uv[v]);
    faces.add(polygon, corners);
  }
  write_ply(file_, positions, faces);
  EXPECT_NE(written().find("property double t\n"), std::string::npos);
  const MeshFaces read = read_ply(file_).faces;
  EXPECT_EQ(read.corners, faces.corners);
  EXPECT_EQ(read.ends, faces.ends);
  ASSERT_EQ(read.uv.size(), faces.uv.size());
  for (std::size_t c = 0; c < read.uv.size(); ++c) EXPECT_EQ(bits_of(read.uv[c]), bits_of(faces.uv[c]));
}

TEST_F(PlyWriter, RoundsFloats) {
  Random random(1);
  TriangleMesh mesh{.positions = {}, .triangles = {{0, 1, 2}}};
  for (int v = 0; v < 100; ++v)
    mesh.positions.emplace_back(random.uniform(-1, 1), random.uniform(-1e-30, 1e-30),
                                random.uniform(-1e30, 1e30));
  write_ply(file_, mesh.positions, make_faces(mesh.triangles), PlyNumbers::floats);
  const TriangleMesh read = read_ply(file_).mesh;
  for (std::size_t v = 0; v < 100; ++v)
    EXPECT_TRUE(have_same_bits(read.positions[v], mesh.positions[v].cast<float>().cast<double>()));
}

TEST_F(PlyWriter, WritesPolygonsThatAreCutAsBefore) {
  Random random(1);
  for (const int num_corners : {4, 127, 128, 300}) {  // lists of bytes, and longer ones
    MeshFromFile expected;
    for (int v = 0; v < 400; ++v)
      expected.mesh.positions.emplace_back(random.uniform(-1, 1), random.uniform(-1, 1), 0);
    for (int p = 0; p < 10; ++p) {
      std::vector<int> polygon;
      std::vector<Eigen::Vector2d> corners;
      for (int c = 0; c < (p % 2 == 0 ? num_corners : 3); ++c) {
        polygon.push_back(random_index(random, 400));
        corners.emplace_back(random.uniform(0, 1), random.uniform(0, 1));
      }
      append_polygon(polygon, corners, expected);
    }
    write_ply(file_, expected.mesh.positions, expected.faces);
    const MeshFromFile read = read_ply(file_);
    EXPECT_EQ(read.mesh.positions, expected.mesh.positions);
    EXPECT_EQ(read.mesh.triangles, expected.mesh.triangles);
    EXPECT_EQ(read.uv, expected.uv);
    EXPECT_EQ(read.faces.corners, expected.faces.corners);
    EXPECT_EQ(read.faces.ends, expected.faces.ends);
    EXPECT_EQ(read.faces.uv, expected.faces.uv);
  }
}

TEST_F(PlyWriter, KeepsCornersWithoutTextureCoordinates) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const TriangleMesh mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                          .triangles = {{0, 1, 2}, {2, 1, 0}}};
  const Eigen::Vector2d none(kNone, kNone), given(0.1, 0.2);
  write_ply(file_, mesh.positions, make_faces(mesh.triangles, {{none, none, none}, {none, given, given}}));
  const MeshFromFile read = read_ply(file_);
  ASSERT_EQ(read.uv.size(), 2u);
  for (const Eigen::Vector2d& corner : read.uv[0]) EXPECT_TRUE(std::isnan(corner.x()));
  EXPECT_TRUE(std::isnan(read.uv[1][0].x()));
  EXPECT_EQ(read.uv[1][1], given);
}

TEST_F(PlyWriter, FullDiskAndMissingFolderAreErrorsWithTheFilesName) {
  const TriangleMesh mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}};
  for (const std::string file : {"/dev/full", "no_such_folder/x.ply"}) {
    try {
      write_ply(file, mesh.positions, make_faces(mesh.triangles));
      ADD_FAILURE();
    } catch (const InputError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(file + " cannot be written: ")) << error.what();
    }
  }
}

}  // namespace
}  // namespace weft::engine
