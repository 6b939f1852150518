#pragma once
/// The stiffness of a grid's springs that makes it stretch and shear like a fabric.
///
///     o──kx──o     Springs along the edges and one or both diagonals of a cell of dx × dz. A homogeneous
///     | \  / |     strain stores, per area, with l² = dx² + dz²:
///     kz \/ kz
///     |  /\  |         C11 = (kx dx² + 2 kd dx⁴/l²)/(dx dz)     C22 likewise with kz and dz
///     | /  \ |         C12 = G = 2 kd dx² dz²/(l² dx dz)        kd: of each of two diagonals
///     o──kx──o
///
/// so that kd = G l²/(2 dx dz), kx = (C11 − G dx²/dz²) dz/dx, kz = (C22 − G dz²/dx²) dx/dz; one diagonal per
/// cell takes 2 kd; springs on the border stand for half a row of cells and have half kx or kz. Springs
/// cannot help C12 = G, and need C11 > G dx²/dz² and C22 > G dz²/dx².

#include <string>
#include <vector>

#include "weft/fabric/bending_rows.h"
#include "weft/fabric.h"
#include "weft/mesh/grid.h"

namespace weft::engine {

/// Which diagonals of a cell have springs.
enum class CellDiagonals {
  both,
  alternating,  // one per cell, turned from cell to cell: the same C
  parallel,  // one per cell, all the same way: stretch turns into shear too, by C16 = G dx/dz, C26 = G dz/dx
};

/// Stiffness of the springs [N/m].
struct GridSprings {
  double along_x = 0;                 // of inner springs along the first axis; those on the border have half
  double along_z = 0;                 // along the second axis, likewise
  double diagonal = 0;                // of every diagonal
  std::vector<std::string> warnings;  // what of the fabric the springs change, by name
};

/// Throws InputError where springs cannot be the fabric (c11 or c22 too small beside g), with what to do;
/// `name` is how the fabric is called in the message. Bending is BendingRows' business.
GridSprings make_grid_springs(const Grid& grid, CellDiagonals diagonals, GridWarp warp, const Fabric& fabric,
                              const std::string& name);

}  // namespace weft::engine
