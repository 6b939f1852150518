#pragma once
/// The common result of the readers of mesh files.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// Faces of a file from `begin` to before `end`.
struct FaceRange {
  int begin = 0, end = 0;
  bool operator==(const FaceRange&) const = default;
};

/// A named part of a mesh. A face may be in several.
struct MeshGroup {
  std::string name;
  bool is_object = false;        // of an OBJ file: named by a line o, not by a line g
  std::vector<FaceRange> faces;  // at least one face, ascending, neither overlapping nor adjacent
  bool operator==(const MeshGroup&) const = default;
};

/// The faces of a file: polygons, with the texture coordinates of their corners and the groups' names.
struct MeshFaces {
  std::vector<int> corners;               // vertices of the first face, then of the second, …
  std::vector<std::size_t> ends;          // (faces) end of each face in `corners`
  std::vector<Eigen::Vector2d> uv;        // (corners) v up, NaN where the file has none; empty if it has none
  std::vector<MeshGroup> groups;          // in the order of their first faces
  std::vector<std::array<int, 2>> lines;  // vertices that lines join

  std::size_t size() const { return ends.size(); }
  std::size_t begin_of(std::size_t face) const { return face == 0 ? 0 : ends[face - 1]; }
  /// Vertices of a face, three or more.
  std::span<const int> operator[](std::size_t face) const {
    return std::span(corners).subspan(begin_of(face), ends[face] - begin_of(face));
  }
  /// Texture coordinates of a face's corners; empty if there are none at all.
  std::span<const Eigen::Vector2d> uv_of(std::size_t face) const {
    if (uv.empty()) return {};
    return std::span(uv).subspan(begin_of(face), ends[face] - begin_of(face));
  }

  /// Appends a face. `corner_uv`: one for each corner; empty in all faces or in none.
  void add(std::span<const int> polygon, std::span<const Eigen::Vector2d> corner_uv = {});
};

/// The bits of texture coordinates, for comparisons.
inline std::array<std::uint64_t, 2> bits_of(const Eigen::Vector2d& uv) {
  return {std::bit_cast<std::uint64_t>(uv.x()), std::bit_cast<std::uint64_t>(uv.y())};
}

/// Triangles as faces. `uv` as in MeshFromFile.
MeshFaces make_faces(const std::vector<Triangle>& triangles, const std::vector<CornerUv>& uv = {});

struct MeshFromFile {
  TriangleMesh mesh;         // everything in the file together
  std::vector<CornerUv> uv;  // (num_triangles) of the corners, v up, NaN where the file has none; empty
                             // if it has none at all
  MeshFaces faces;           // of which the triangles are cut
  std::vector<std::string> warnings;  // ignored contents, one message for each kind, with counts
};

/// The end of messages about a file of a sequence.
inline constexpr const char* kSameFaces =
    "; all files of a sequence must have the same vertices and faces, in the same order";

/// Appends a face: n vertices of `result`, n >= 3, and its n - 2 triangles, by ear clipping; it may be concave.
/// Positions must be complete. `uv`: (n) texture coordinates of the corners, or empty to append none.
void append_polygon(std::span<const int> polygon, std::span<const Eigen::Vector2d> uv, MeshFromFile& result);

}  // namespace weft::engine
