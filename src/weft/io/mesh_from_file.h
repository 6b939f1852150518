#pragma once
/// The common result of the readers of mesh files.

#include <span>
#include <string>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

struct MeshFromFile {
  TriangleMesh mesh;         // everything in the file together
  std::vector<CornerUv> uv;  // (num_triangles) of the triangles' corners, NaN where the file has none; empty
                             // if it has none at all
  std::vector<std::string> warnings;  // ignored contents, one message for each kind, with counts
};

/// Appends a face: n vertices of `result`, n >= 3, as n - 2 triangles, by ear clipping; it may be concave.
/// Positions must be complete. `uv`: (n) texture coordinates of the corners, or empty to append none.
void append_polygon(std::span<const int> polygon, std::span<const Eigen::Vector2d> uv, MeshFromFile& result);

}  // namespace weft::engine
