#pragma once
/// Flat sheets for tests of membranes and bending: square grids, and random meshes of the same fineness.

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "weft/forces/hinge.h"
#include "weft/forces/membrane.h"
#include "weft/mesh/sample_meshes.h"

namespace weft::engine::test {

/// A sheet in the x–z plane, cut into cells² squares of two triangles.
enum class SheetKind {
  parallel,     // all diagonals along (i,j)–(i+1,j+1)
  alternating,  // alternating from cell to cell
  random,       // inner vertices moved by up to 0.3 cells, each cell cut along its shorter diagonal
};

inline const char* to_string(SheetKind kind) {
  switch (kind) {
    case SheetKind::parallel:
      return "parallel";
    case SheetKind::alternating:
      return "alternating";
    case SheetKind::random:
      break;
  }
  return "random";
}

inline TriangleMesh make_sheet(SheetKind kind, const Grid& grid, std::uint64_t seed = 1) {
  if (kind == SheetKind::random) return build_random_mesh(grid, seed);
  const bool parallel = kind == SheetKind::parallel;
  return build_grid_mesh(grid, parallel ? GridDiagonals::parallel : GridDiagonals::alternating);
}

inline TriangleMesh make_sheet(SheetKind kind, int cells) {
  return make_sheet(kind, {.size_x = 1, .size_z = 1, .cells_x = cells, .cells_z = cells});
}

/// The mesh's positions after a map of space.
inline std::vector<Vec3> mapped(const TriangleMesh& mesh, const std::function<Vec3(const Vec3&)>& map) {
  std::vector<Vec3> x;
  for (const Vec3& p : mesh.positions) x.push_back(map(p));
  return x;
}

/// Rolled to a cylinder of this curvature, in the direction ψ from x; lengths are kept.
inline std::vector<Vec3> rolled(const TriangleMesh& mesh, double curvature, double psi) {
  const double c = std::cos(psi), s = std::sin(psi);
  return mapped(mesh, [=](const Vec3& p) {
    const double along = c * p.x() + s * p.z(), across = c * p.z() - s * p.x();
    const double x = std::sin(curvature * along) / curvature;
    return Vec3(c * x - s * across, (1 - std::cos(curvature * along)) / curvature, s * x + c * across);
  });
}

}  // namespace weft::engine::test
