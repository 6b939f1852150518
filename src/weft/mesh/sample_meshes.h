#pragma once
/// Flat unstructured meshes for tests and studies, representative of any mesh.

#include <cstdint>

#include "weft/mesh/grid.h"

namespace weft::engine {

/// The grid's vertices, inner ones displaced at random by up to 0.3 cells, each cell cut along its shorter
/// diagonal. The same for the same seed, on every machine.
TriangleMesh build_random_mesh(const Grid& grid, std::uint64_t seed);

/// A disc around the origin in the x–z plane: ring k of `num_rings` >= 1 has 6 k vertices, so that triangles
/// are nearly equilateral. Ring by ring from the centre, each from +x towards −z.
TriangleMesh build_disc_mesh(double radius, int num_rings);

}  // namespace weft::engine
