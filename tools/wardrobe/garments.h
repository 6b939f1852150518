#pragma once
/// Garments for the figure at rest, with typical defects of user meshes: no texture coordinates, slivers,
/// gaps between borders, linings, pleats.

#include <vector>

#include "tools/wardrobe/figure.h"
#include "weft/cloth.h"

namespace weft::engine::wardrobe {

/// With cells of about `cell` [m]; 0.009 gives a T-shirt of 10,000 vertices.
TriangleMesh make_tshirt(double cell);
/// The sleeves are higher than the figure's arms, which start half outside them.
TriangleMesh make_shirt(double cell, double lift_deg);
/// With slivers of 0.1 mm at waist and ankles.
TriangleMesh make_trousers(double cell);
TriangleMesh make_skirt(double cell);
/// A T-shirt to be worn over the skirt, to below the waist.
TriangleMesh make_shirt_over_skirt(double cell);
/// Open in front; a lining 1 mm inside, in the same mesh.
TriangleMesh make_coat(double cell);
/// Three layers round the neck.
TriangleMesh make_scarf(double cell);
/// A bodice of four panels and a pleated skirt of six, with borders 0.2 to 2 mm apart.
TriangleMesh make_pleated_dress(double cell);

/// Flat panels, and the seams that make a garment of them.
struct Pattern {
  TriangleMesh mesh;
  std::vector<CornerUv> uv;  // (triangles) along warp, across the panels' height [m]
  std::vector<Seam> seams;
};
/// A sleeveless dress of two panels, before and behind the figure, with seams at shoulders and sides.
Pattern make_dress_pattern(double cell);

/// Level, above the head.
TriangleMesh make_sheet(double side, int num_cells);

}  // namespace weft::engine::wardrobe
