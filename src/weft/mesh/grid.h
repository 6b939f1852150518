#pragma once
/// Rectangular cloth as a grid of particles.
///
/// The grid lies horizontally: corner (0, 0) at the origin, i along +x, j along +z, row by row:
///
///     (0,0) --- (1,0) --- (2,0)  → x        index = j * (cells_x + 1) + i
///       |         |         |
///     (0,1) --- (1,1) --- (2,1)
///       ↓ z

#include "weft/mesh/triangle_mesh.h"

namespace weft {

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
};

/// Throws InputError for sizes that are not above 0 and finite, and for less than one cell.
void require_valid(const Grid& grid);

/// How each cell is cut into two triangles: all along (i,j)–(i+1,j+1), or the other way in every second cell.
enum class GridDiagonals { parallel, alternating };

/// True if the cell's triangles meet along (i,j)–(i+1,j+1), false if along (i+1,j)–(i,j+1).
inline bool is_main_diagonal(GridDiagonals diagonals, int i, int j) {
  return diagonals == GridDiagonals::parallel || (i + j) % 2 == 0;
}

TriangleMesh build_grid_mesh(const Grid& grid, GridDiagonals diagonals);

/// A quarter of the area of the cells around each particle (num_particles) [m²]; the cut does not matter.
std::vector<double> compute_grid_areas(const Grid& grid);

}  // namespace weft
