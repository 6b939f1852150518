#pragma once
/// Shrinking of solid meshes: cloth that starts inside can be outside while they grow back.

#include <vector>

#include "weft/core/job_system.h"
#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// The radius of the largest ball inside a closed mesh that touches it at each vertex (num_vertices) [m]: the
/// shrinking ball of Ma, Bae and Choi (2012, "3D medial axis point approximation using nearest neighbors and
/// the normal field"). Triangles that face the same way as the vertex belong to a sheet that covers the solid
/// (hair, or skin that intersects itself), and are skipped. At most `most` [m]: less is faster.
///
///         n ↑
///     ──────p──────      c = p − R n,   R ← |p − q|²/(2 n·(p − q))
///        (  c  )         for the surface point q nearest to c, until none is nearer than p
///     ──────q──────
std::vector<double> compute_inner_radii(const TriangleMesh& mesh, double most, JobSystem& jobs);

constexpr double kMaxShrinkage = 0.9;  // share of the radius by which a mesh becomes thinner at most [1]

/// Vertex positions of a closed mesh that is thinner by `depth` on all sides (num_vertices) [m]; where it is
/// less thick than that, a tenth of its radius remains.
std::vector<Vec3> shrink(const TriangleMesh& mesh, const std::vector<double>& inner_radii, double depth);

}  // namespace weft::engine
