#include "weft/fabric/grid_springs.h"

#include "weft/error.h"
#include "weft/fabric/spring_warnings.h"

namespace weft::engine {
namespace {

void require_stiffer(double c, double shear, const char* key, const Fabric& fabric, const std::string& name) {
  if (c > shear) return;
  const std::string why =
      shear == fabric.g ? "" : " times the cells' (length/width)² = " + short_text(shear) + " N/m";
  throw InputError("fabric \"" + name + "\": springs cannot represent it: " + key + " = " + short_text(c) +
                   " N/m must exceed g = " + short_text(fabric.g) + " N/m" + why +
                   "; use membrane = \"triangle\", a smaller g, or a larger " + key);
}

}  // namespace

GridSprings make_grid_springs(const Grid& grid, CellDiagonals diagonals, GridWarp warp, const Fabric& fabric,
                              const std::string& name) {
  const bool is_first = warp == GridWarp::first_axis;
  const double cx = is_first ? fabric.c11 : fabric.c22, cz = is_first ? fabric.c22 : fabric.c11;
  const double dx = grid.spacing_x(), dz = grid.spacing_z();
  const double shear_x = fabric.g * (dx * dx) / (dz * dz), shear_z = fabric.g * (dz * dz) / (dx * dx);
  require_stiffer(cx, shear_x, is_first ? "c11" : "c22", fabric, name);
  require_stiffer(cz, shear_z, is_first ? "c22" : "c11", fabric, name);

  GridSprings springs;
  springs.warnings = warn_of_springs(fabric, name);
  const double both = fabric.g * (dx * dx + dz * dz) / (2 * dx * dz);
  springs.diagonal = diagonals == CellDiagonals::both ? both : 2 * both;
  springs.along_x = (cx - shear_x) * dz / dx;
  springs.along_z = (cz - shear_z) * dx / dz;
  if (diagonals == CellDiagonals::parallel) {
    springs.warnings.push_back(
        "fabric \"" + name + "\": parallel diagonals, one per cell, couple stretch to shear (c16 = " +
        short_text(fabric.g * dx / dz) + " N/m, c26 = " + short_text(fabric.g * dz / dx) +
        " N/m); alternating diagonals do not");
  }
  return springs;
}

}  // namespace weft::engine
