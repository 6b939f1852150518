#pragma once
/// Spring stiffnesses of a grid that reproduce a fabric's stretching and shearing.
///
///     o──kx──o     Springs along the edges and one or both diagonals of a cell of dx × dz. A homogeneous
///     | \  / |     strain stores, per area, with l² = dx² + dz²:
///     kz \/ kz
///     |  /\  |         C11 = (kx dx² + 2 kd dx⁴/l²)/(dx dz)     C22 likewise with kz and dz
///     | /  \ |         C12 = G = 2 kd dx² dz²/(l² dx dz)        kd: of each of two diagonals
///     o──kx──o
///
/// so that kd = G l²/(2 dx dz), kx = (C11 − G dx²/dz²) dz/dx, kz = (C22 − G dz²/dx²) dx/dz; a single diagonal
/// per cell has 2 kd; springs on the border represent half a row of cells and have half kx or kz. Springs
/// always give C12 = G, and require C11 > G dx²/dz² and C22 > G dz²/dx².

#include <string>
#include <vector>

#include "weft/fabric.h"
#include "weft/fabric/bending_rows.h"
#include "weft/mesh/grid.h"

namespace weft::engine {

/// Diagonals of a cell with springs.
enum class CellDiagonals {
  both,
  alternating,  // one per cell, in alternating direction: the same C
  parallel,     // one per cell, all parallel: stretch couples to shear by C16 = G dx/dz, C26 = G dz/dx
};

/// Stiffness of the springs [N/m].
struct GridSprings {
  double along_x = 0;                 // inner springs along the first axis; half on the border
  double along_z = 0;                 // inner springs along the second axis; half on the border
  double diagonal = 0;                // of every diagonal
  std::vector<std::string> warnings;  // properties of the fabric that the springs change
};

/// Throws InputError for a fabric that springs cannot represent (c11 or c22 too small relative to g), with a
/// remedy; the message calls the fabric `name`. Bending is left to BendingRows.
GridSprings make_grid_springs(const Grid& grid, CellDiagonals diagonals, GridWarp warp, const Fabric& fabric,
                              const std::string& name);

}  // namespace weft::engine
