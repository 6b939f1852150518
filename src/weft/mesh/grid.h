#pragma once
/// Grids as meshes. Grid itself is in weft/mesh.h.

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// Throws InputError for sizes that are not above 0 and finite, and for less than one cell.
void require_valid(const Grid& grid);

/// Diagonals that cut each cell into two triangles: all along (i,j)–(i+1,j+1), or flipped in every second
/// cell.
enum class GridDiagonals { parallel, alternating };

/// Whether the cell's diagonal is (i,j)–(i+1,j+1); else it is (i+1,j)–(i,j+1).
inline bool is_main_diagonal(GridDiagonals diagonals, int i, int j) {
  return diagonals == GridDiagonals::parallel || (i + j) % 2 == 0;
}

TriangleMesh build_grid_mesh(const Grid& grid, GridDiagonals diagonals);

/// A quarter of the area of the cells around each particle (num_particles) [m²], for any diagonals.
std::vector<double> compute_grid_areas(const Grid& grid);

}  // namespace weft::engine
