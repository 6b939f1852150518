#pragma once
/// Unstructured meshes for tests, studies and scenes.

#include <cstdint>

#include "weft/mesh/grid.h"

namespace weft::engine {

/// The grid's vertices, inner ones displaced at random by up to 0.3 cells, each cell cut along its shorter
/// diagonal. The same for the same seed, on every machine.
TriangleMesh build_random_mesh(const Grid& grid, std::uint64_t seed);

/// A disc around the origin in the x–z plane: ring k of `num_rings` >= 1 has 6 k vertices, so that triangles
/// are nearly equilateral. Ring by ring from the centre, each from +x towards −z.
TriangleMesh build_disc_mesh(double radius, int num_rings);

/// A sphere around the origin: an icosahedron, whose triangles are divided into four `divisions` >= 0 times. Faces
/// outwards.
TriangleMesh build_geodesic_mesh(double radius, int divisions);

/// Two square sheets in the x–z plane, joined along their border, with the gap [m] between them elsewhere. Faces
/// outwards.
TriangleMesh build_cushion_mesh(double side, int num_cells, double gap);

}  // namespace weft::engine
