#pragma once
/// Solids made thinner, so that cloth that starts inside can be outside while they grow back.

#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// The radius of the largest ball inside a closed mesh that touches it at each vertex (num_vertices) [m]: the
/// shrinking ball of Ma, Bae and Choi (2012, "3D medial axis point approximation using nearest neighbors and
/// the normal field"). Triangles that face the way the vertex does belong to a sheet that the solid is
/// covered by (hair, or skin that goes through itself), and are passed over.
///
///         n ↑
///     ──────p──────      c = p − R n,   R ← |p − q|²/(2 n·(p − q))
///        (  c  )         for the point q of the surface nearest to c, until there is none nearer than p
///     ──────q──────
std::vector<double> compute_inner_radii(const TriangleMesh& mesh);

/// Where the vertices of a closed mesh are when it is thinner by `depth` on all sides (num_vertices) [m];
/// where it is not so thick, it keeps a tenth of its radius.
std::vector<Vec3> shrink(const TriangleMesh& mesh, const std::vector<double>& inner_radii, double depth);

}  // namespace weft::engine
