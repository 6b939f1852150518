#pragma once
/// Tears: edges of a mesh that join its triangles no longer.
///
///     o-----a-----o      The corners at a vertex are one vertex as long as edges that hold join their triangles.
///     | \   |   / |      Edge v–a broken: v is still whole. Edges v–a and v–b broken: v is two vertices, and the
///     |   \ | /   |      mesh has a slit from a to b. On a border one broken edge is enough.
///     o-----v-----o
///     |   / | \   |      Broken edges are numbers of edges in build_edges() of the whole mesh, ascending. The same
///     | /   |   \ |      edges give the same mesh, in whatever order they broke.
///     o-----b-----o

#include <span>
#include <vector>

#include "weft/mesh/rest_mesh.h"

namespace weft::engine {

/// The mesh with its tears. Triangles keep their numbers and their shapes at rest. The part of a vertex with its first
/// corner keeps the number. Other parts follow behind all vertices, in the order of their first corners. Parts of a vertex
/// have different positions (see draw_in). Throws InputError for an edge that is not there.
RestMesh tear_mesh(const RestMesh& whole, std::span<const int> broken);

/// For each of `num_vertices` vertices of `triangles` the one at its first corner among `others`, or its own number.
std::vector<int> find_same_corners(const std::vector<Triangle>& triangles, int num_vertices,
                                   const std::vector<Triangle>& others);

/// Moves the chosen vertices (num_vertices) a fiftieth of the way to the middle of their triangles. The two sides of a
/// new tear then do not coincide.
void draw_in(const std::vector<Triangle>& triangles, std::span<const char> is_chosen,
             std::vector<Vec3>& positions);

}  // namespace weft::engine
