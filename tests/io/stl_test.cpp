/// STL files, text and binary, become meshes with joined vertices. Damaged ones are refused with the place.

#include "weft/io/stl.h"

#include <gtest/gtest.h>

#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <sstream>

#include "weft/core/random.h"
#include "weft/error.h"

namespace weft::engine {
namespace {

using Point = std::array<float, 3>;
using Facet = std::array<Point, 3>;

template <class Number>
std::string with(std::string bytes, std::size_t at, Number number) {
  return bytes.replace(at, sizeof number, reinterpret_cast<const char*>(&number), sizeof number);
}

/// A binary file; `start` begins its header.
std::string make_binary(const std::vector<Facet>& facets, std::string start = "") {
  start.resize(80);
  std::string bytes = start + std::string(4, '\0');
  bytes = with(bytes, 80, static_cast<std::uint32_t>(facets.size()));
  for (const Facet& facet : facets) {
    std::string record(50, '\x7F');  // normals that are not numbers, and attributes
    std::memcpy(&record[12], facet.data(), sizeof facet);
    bytes += record;
  }
  return bytes;
}

std::string make_text(const std::vector<Facet>& facets) {
  std::ostringstream text;
  text.precision(9);
  text << "solid facet of a name\n";
  for (const Facet& facet : facets) {
    text << "  facet normal 0 0 1\n    outer loop\n";
    for (const Point& p : facet) text << "      vertex " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    text << "    endloop\n  endfacet\n";
  }
  text << "endsolid facet of a name\n";
  return text.str();
}

const Facet kFacet = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
const std::vector<Facet> kSquare = {kFacet, {{{1, 0, 0}, {1, 1, 0}, {-0.0F, 1, -0.0F}}}};

MeshFromFile parse(const std::string& bytes) { return parse_stl(bytes, "x.stl"); }

/// The error message for these bytes; every message is one line that begins with the file.
std::string failure(const std::string& bytes) {
  try {
    parse(bytes);
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with("x.stl:")) << message;
    EXPECT_EQ(message.find('\n'), message.npos) << message;
    return message;
  }
  return "no error";
}

// ---- Valid files ----

TEST(StlReader, ReadsTheFormatsBytes) {
  const std::string bytes = std::string(80, ' ') + std::string(
                                                       "\1\0\0\0"
                                                       "\0\0\0\0\0\0\0\0\0\0\x80\x3F"
                                                       "\0\0\0\0\0\0\0\0\0\0\x80\x3F"
                                                       "\0\0\0\x40\0\0\0\0\0\0\x80\x3F"
                                                       "\0\0\0\0\0\0\0\xC0\xDB\x0F\x49\x40"
                                                       "\0\0",
                                                       54);
  const MeshFromFile read = parse(bytes);
  ASSERT_EQ(read.mesh.num_vertices(), 3);
  EXPECT_EQ(read.mesh.positions[0], Vec3(0, 0, 1));
  EXPECT_EQ(read.mesh.positions[1], Vec3(2, 0, 1));
  EXPECT_EQ(read.mesh.positions[2], Vec3(0, -2, 3.14159274101257324));
  EXPECT_EQ(read.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_TRUE(read.uv.empty());
  EXPECT_TRUE(read.warnings.empty());
}

TEST(StlReader, JoinsCoincidentVerticesOfBothForms) {
  for (const std::string& bytes : {make_binary(kSquare), make_text(kSquare)}) {
    const MeshFromFile read = parse(bytes);
    EXPECT_EQ(read.mesh.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
    EXPECT_EQ(read.faces.corners, make_faces(read.mesh.triangles).corners);
    EXPECT_EQ(read.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}}));
    EXPECT_TRUE(read.warnings.empty());
  }
}

TEST(StlReader, KeepsVerticesApartThatDifferInTheLastBit) {
  std::vector<Facet> facets = kSquare;
  facets[1][0][0] = std::nextafter(1.0F, 2.0F);
  EXPECT_EQ(parse(make_binary(facets)).mesh.num_vertices(), 5);
  EXPECT_EQ(parse(make_text(facets)).mesh.num_vertices(), 5);
}

TEST(StlReader, ReadsTheSameMeshFromBothForms) {
  Random random(1);
  std::vector<Facet> facets;
  for (int k = 0; k < 300; ++k) {
    Facet& facet = facets.emplace_back();
    for (Point& point : facet) {
      for (float& coordinate : point) coordinate = 0.1F * static_cast<float>(random.next() % 8);
    }
  }
  const MeshFromFile binary = parse(make_binary(facets)), text = parse(make_text(facets));
  EXPECT_EQ(binary.mesh.positions, text.mesh.positions);
  EXPECT_EQ(binary.mesh.triangles, text.mesh.triangles);
  EXPECT_LE(binary.mesh.num_vertices(), 8 * 8 * 8);
  // Every facet with area is there, with its corners in their order.
  std::size_t next = 0;
  for (const Facet& facet : facets) {
    std::array<Vec3, 3> x;
    for (int c = 0; c < 3; ++c) x[c] = Vec3(facet[c][0], facet[c][1], facet[c][2]);
    if ((x[1] - x[0]).cross(x[2] - x[0]).norm() == 0) continue;
    ASSERT_LT(next, binary.mesh.triangles.size());
    for (int c = 0; c < 3; ++c) EXPECT_EQ(binary.mesh.positions[binary.mesh.triangles[next][c]], x[c]);
    ++next;
  }
  EXPECT_EQ(next, binary.mesh.triangles.size());
}

TEST(StlReader, DecidesBySizeWhetherAFileThatBeginsWithSolidIsBinary) {
  EXPECT_EQ(parse(make_binary(kSquare, "solid made by a program")).mesh.num_triangles(), 2);
  // Not of that size: text.
  EXPECT_EQ(
      failure(make_binary(kSquare, "solid made by a program\nx") + '\n'),
      "x.stl:2: unknown word 'x???????????????????????????????????????…'; expected solid, facet, outer loop, "
      "vertex, endloop, endfacet or endsolid");
}

TEST(StlReader, DropsFacetsWithoutAreaAndCountsThem) {
  const std::vector<Facet> facets = {
      kFacet,
      {{{5, 5, 5}, {5, 5, 5}, {6, 5, 5}}},          // two corners coincide
      {{{0, 0, 0}, {0.25F, 0.25F, 0}, {3, 3, 0}}},  // straight
      {{{0, 0, 7}, {-0.0F, 0, 7}, {0, 1, 7}}},      // coincide: −0 is 0
      {{{0, 0, 0}, {1, 0, 0}, {2, 1e-20F, 0}}},     // thin
  };
  for (const std::string& bytes : {make_binary(facets), make_text(facets)}) {
    const MeshFromFile read = parse(bytes);
    EXPECT_EQ(read.mesh.num_triangles(), 2);
    EXPECT_EQ(read.mesh.num_vertices(), 4);  // none of the dropped facets
    EXPECT_EQ(read.warnings,
              std::vector<std::string>{"x.stl: 3 facets without area were dropped; the first is facet 1"});
  }
}

TEST(StlReader, TakesCapitalsSeveralSolidsAndBothLineEnds) {
  std::string upper = make_text(kSquare);
  for (char& c : upper) c = static_cast<char>(std::toupper(c));
  std::string crlf;
  for (const char c : make_text(kSquare)) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  for (const std::string& text : {upper, crlf, "\n " + make_text(kSquare) + "\n\n",
                                  make_text({kSquare[0]}) + make_text({kSquare[1]})}) {
    const MeshFromFile read = parse(text);
    EXPECT_EQ(read.mesh.num_vertices(), 4);
    EXPECT_EQ(read.mesh.num_triangles(), 2);
  }
}

TEST(StlReader, WarnsOfBytesBehindTheLastFacet) {
  const MeshFromFile read = parse(make_binary(kSquare) + "123");
  EXPECT_EQ(read.mesh.num_triangles(), 2);
  EXPECT_EQ(read.warnings, std::vector<std::string>{"x.stl: 3 bytes behind the last facet were ignored"});
}

// ---- Damage ----

TEST(StlReader, NamesTheLineOfAMistakeInText) {
  const std::string order =
      " is out of order; expected solid, then for each facet the lines facet, outer loop, three lines "
      "vertex X Y Z, endloop, endfacet, then endsolid";
  const std::string begin = "solid\nfacet normal 0 0 1\nouter loop\n";
  const std::string vertices = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n";
  const std::string end = "endloop\nendfacet\n";
  EXPECT_EQ(failure(begin + vertices + end + "endsolid"), "no error");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"solid\nendsolid\n", "x.stl: there are no facets with area"},
      {"solid\nface normal 0 0 1\n",
       "x.stl:2: unknown word 'face'; expected solid, facet, outer loop, vertex, endloop, endfacet or "
       "endsolid"},
      {begin + "vertex 0 0\n",
       "x.stl:4: a vertex with 2 coordinates; expected vertex X Y Z with three numbers"},
      {begin + "vertex 0 0 0 0\n",
       "x.stl:4: a vertex with 4 coordinates; expected vertex X Y Z with three numbers"},
      {begin + "\nvertex 0 nan 0\n", "x.stl:5: 'nan' is not a coordinate; expected a finite float"},
      {begin + "vertex 0 0 -inf\n", "x.stl:4: '-inf' is not a coordinate; expected a finite float"},
      {begin + "vertex 1e39 0 0\n", "x.stl:4: '1e39' is not a coordinate; expected a finite float"},
      {begin + "vertex 1,5 0 0\n", "x.stl:4: '1,5' is not a coordinate; expected a finite float"},
      {begin + "vertex 0 0 0\n" + end, "x.stl:6: a facet with 1 vertices; expected three"},
      {begin + vertices + "vertex 1 1 0\n" + end, "x.stl:9: a facet with 4 vertices; expected three"},
      {begin + vertices + "facet\n", "x.stl:7: 'facet'" + order},
      {begin + vertices + "endsolid\n", "x.stl:7: 'endsolid'" + order},
      {begin + vertices + end + "vertex 0 0 0\n", "x.stl:9: 'vertex'" + order},
      {begin + vertices + end + "endfacet\n", "x.stl:9: 'endfacet'" + order},
      {begin + vertices + end + "endloop\n", "x.stl:9: 'endloop'" + order},
      {begin + vertices + end + "solid\n", "x.stl:9: 'solid'" + order},
      {begin + vertices + end + "endsolid\nfacet\n", "x.stl:10: 'facet'" + order},
      {begin + vertices + end + "endsolid\nendsolid\n", "x.stl:10: 'endsolid'" + order},
      {begin + vertices + end, "x.stl:8: the file ends in a solid; expected endsolid"},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(failure(text), message) << text;
}

TEST(StlReader, NamesTheByteOfAMistakeInABinaryFile) {
  const std::string good = make_binary(kSquare);
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "x.stl: byte 0: the file ends; expected the word solid, or a binary header of 84 bytes"},
      {good.substr(0, 83),
       "x.stl: byte 83: the file ends; expected the word solid, or a binary header of 84 bytes"},
      {make_binary({}), "x.stl: there are no facets with area"},
      {with(good, 80, std::uint32_t{3}), "x.stl: byte 80: 3 facets, but the file holds 2"},
      {with(good, 80, std::uint32_t{0x80000000}), "x.stl: byte 80: 2147483648 facets, but the file holds 2"},
      {with(good, 80, std::uint32_t{0xFFFFFFFF}), "x.stl: byte 80: 4294967295 facets, but the file holds 2"},
      {with(good, 84 + 12 + 4 * 4, std::numeric_limits<float>::quiet_NaN()),
       "x.stl: byte 112: the coordinate is not a finite number"},
      {with(good, 84 + 50 + 12, -std::numeric_limits<float>::infinity()),
       "x.stl: byte 146: the coordinate is not a finite number"},
  };
  for (const auto& [bytes, message] : cases) EXPECT_EQ(failure(bytes), message);
  for (std::size_t length = 84; length < good.size(); ++length)
    EXPECT_EQ(failure(good.substr(0, length)),
              "x.stl: byte 80: 2 facets, but the file holds " + std::to_string((length - 84) / 50));
}

TEST(StlReader, TruncatedTextIsRefusedAtEveryLine) {
  const std::string good = make_text(kSquare);
  for (std::size_t end = good.find('\n'); end + 1 < good.size(); end = good.find('\n', end + 1))
    EXPECT_TRUE(failure(good.substr(0, end)).starts_with("x.stl:")) << end;
}

TEST(StlReader, RefusesFoldersAndMissingFiles) {
  EXPECT_THROW(read_stl(testing::TempDir()), InputError);
  EXPECT_THROW(read_stl(testing::TempDir() + "no_such_file.stl"), InputError);
}

TEST(StlReader, EndsInAMeshOrAnInputErrorOnDamagedBytes) {
  const std::vector<std::string> sound = {make_binary(kSquare), make_text(kSquare)};
  std::mt19937 random(1);
  int num_read = 0;
  for (int trial = 0; trial < 10000; ++trial) {
    const std::string& original = sound[trial % 2];
    std::string bytes = original;
    for (int k = 0; k < 1 + trial % 5; ++k)
      bytes[random() % bytes.size()] =
          trial % 2 == 0 ? static_cast<char>(random()) : original[random() % original.size()];
    try {
      const MeshFromFile read = parse(bytes);
      ++num_read;
      for (const Vec3& position : read.mesh.positions) ASSERT_TRUE(position.allFinite());
      for (const Triangle& triangle : read.mesh.triangles) {
        for (const int v : triangle) ASSERT_TRUE(0 <= v && v < read.mesh.num_vertices());
      }
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(num_read, 500);  // the damage is often harmless
}

}  // namespace
}  // namespace weft::engine
