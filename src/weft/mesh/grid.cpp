#include "weft/mesh/grid.h"

#include <cmath>

#include "weft/error.h"

namespace weft::engine {

void require_valid(const Grid& grid) {
  for (const double size : {grid.size_x, grid.size_z}) {
    if (!std::isfinite(size) || size <= 0) throw InputError("a grid's size must be more than 0 m");
  }
  if (grid.cells_x < 1 || grid.cells_z < 1)
    throw InputError("a grid requires at least one cell along each side");
  constexpr double kMaxParticles = 1e8;
  if ((grid.cells_x + 1.0) * (grid.cells_z + 1.0) > kMaxParticles)
    throw InputError("a grid may have at most 100 million particles");
}

TriangleMesh build_grid_mesh(const Grid& grid, GridDiagonals diagonals) {
  TriangleMesh mesh;
  mesh.positions.reserve(grid.num_particles());
  for (int j = 0; j < grid.num_rows(); ++j) {
    for (int i = 0; i < grid.num_columns(); ++i) {
      mesh.positions.emplace_back(grid.size_x * i / grid.cells_x, 0, grid.size_z * j / grid.cells_z);
    }
  }
  mesh.triangles.reserve(2 * grid.cells_x * grid.cells_z);
  for (int j = 0; j < grid.cells_z; ++j) {
    for (int i = 0; i < grid.cells_x; ++i) {
      const int a = grid.index(i, j), b = grid.index(i + 1, j);
      const int c = grid.index(i, j + 1), d = grid.index(i + 1, j + 1);
      if (is_main_diagonal(diagonals, i, j)) {
        mesh.triangles.push_back({a, c, d});
        mesh.triangles.push_back({a, d, b});
      } else {
        mesh.triangles.push_back({a, c, b});
        mesh.triangles.push_back({b, c, d});
      }
    }
  }
  return mesh;
}

std::vector<double> compute_grid_areas(const Grid& grid) {
  const double quarter = grid.spacing_x() * grid.spacing_z() / 4;
  std::vector<double> areas;
  areas.reserve(grid.num_particles());
  for (int j = 0; j < grid.num_rows(); ++j) {
    for (int i = 0; i < grid.num_columns(); ++i) {
      const int cells_across = (i > 0) + (i < grid.cells_x);
      const int cells_along = (j > 0) + (j < grid.cells_z);
      areas.push_back(quarter * cells_across * cells_along);
    }
  }
  return areas;
}

}  // namespace weft::engine
