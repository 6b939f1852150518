#pragma once
/// Shapes of cloth and of mesh colliders: grids and triangle meshes; intersections of surfaces.

#include <array>
#include <optional>
#include <vector>

#include "weft/export.h"
#include "weft/vec.h"

namespace weft {

/// Rectangular cloth as a grid of particles.
///
/// The grid is horizontal: corner (0, 0) at the origin, i along +x, j along +z, row by row:
///
///     (0,0) --- (1,0) --- (2,0)  → x        index = j * (cells_x + 1) + i
///       |         |         |
///     (0,1) --- (1,1) --- (2,1)
///       ↓ z
struct Grid {
  double size_x = 1;  // > 0 [m]
  double size_z = 1;  // > 0 [m]
  int cells_x = 32;   // >= 1
  int cells_z = 32;   // >= 1

  int num_columns() const { return cells_x + 1; }
  int num_rows() const { return cells_z + 1; }
  int num_particles() const { return num_columns() * num_rows(); }
  int index(int i, int j) const { return j * num_columns() + i; }
  double spacing_x() const { return size_x / cells_x; }
  double spacing_z() const { return size_z / cells_z; }
  bool operator==(const Grid&) const = default;
};

using Triangle = std::array<int, 3>;  // vertex indices, counter-clockwise seen from the front

/// Texture coordinates (u, v) of a triangle's corners.
using CornerUv = std::array<std::array<double, 2>, 3>;

/// Any triangle mesh. For cloth, its positions are the rest shape.
struct TriangleMesh {
  std::vector<Vec3> positions = {};      // (num_vertices), finite [m]
  std::vector<Triangle> triangles = {};  // (num_triangles), at least one
  std::vector<CornerUv> uv = {};         // (num_triangles), or empty; warp runs along u

  int num_vertices() const { return static_cast<int>(positions.size()); }
  int num_triangles() const { return static_cast<int>(triangles.size()); }
};

/// The places of a triangle's corners [m].
using TriangleCorners = std::array<Vec3, 3>;

/// The triangles of a garment's pattern, for ClothDesc::rest: those of the mesh's texture coordinates times `scale`
/// [m]; empty: the scale at which they have the area of the mesh. Throws InputError for a mesh without texture
/// coordinates, for some without area, and for a scale that is not above 0.
WEFT_API std::vector<TriangleCorners> rest_from_uv(const TriangleMesh& mesh,
                                                   std::optional<double> scale = {});

/// A triangle mesh in one frame.
struct Surface {
  std::vector<Vec3> positions = {};  // [m]
  std::vector<Triangle> triangles = {};
  bool is_cloth = true;  // other surfaces may cross themselves and each other
};

/// Two triangles that cross: indices of surfaces, and of their triangles. The first belongs to a cloth.
struct Crossing {
  int surface = 0, triangle = 0;
  int other_surface = 0, other_triangle = 0;

  bool operator==(const Crossing&) const = default;
};

/// All pairs of triangles that cross, in order; exact arithmetic. Surfaces that only touch do not cross. Shares no code
/// with the contact of steps; link weft::scene. Throws InputError for a triangle with a vertex that is not there, and for
/// positions that are not finite floats.
WEFT_API std::vector<Crossing> find_crossings(const std::vector<Surface>& surfaces);

}  // namespace weft
