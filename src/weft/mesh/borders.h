#pragma once
/// Private to mesh/: borders of a mesh as divisible polylines.
///
///         o-----o-----o         Border edges have exactly one triangle. A border is closed, unless it meets
///        / \   / \   / \        an edge of more than two triangles. It runs around the triangles, in either
///       1---2-*-3---4---5       orientation; a vertex where two borders touch has a node in each.
///         →     * a divided edge: a node without a vertex of the mesh

#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// A border edge of the mesh, in the border's direction.
struct BorderEdge {
  int a = 0, b = 0;            // vertices
  int triangle = 0;            // its triangle
  int border = 0, piece = 0;   // indices of its border and connected component
  double arc = 0;              // length of the border up to it [m]
  double length = 0;           // [m]
  Vec3 tangent, inward, side;  // from a to b; into the triangle; tangent × inward; unit vectors
};

/// Whether the way from a to b goes over the cloth between them, as in a ribbon, not through a slit.
inline bool is_across_cloth(const BorderEdge& a, const BorderEdge& b, const Vec3& way) {
  const double facing = 0.5 * way.norm();
  return a.inward.dot(way) > facing && b.inward.dot(-way) > facing;
}

/// A point of a border, and the part of an edge from it to the next node.
struct BorderNode {
  int vertex = 0;  // of the mesh; those of divided edges follow the mesh's own
  int edge = -1;   // its BorderEdge, towards the next node; -1 at the end of an open border
  double t = 0;    // position on that edge, 0 at a vertex of the mesh [1]
  int previous = -1, next = -1;
  Vec3 position;  // [m]
};

struct Borders {
  std::vector<BorderEdge> edges;
  std::vector<BorderNode> nodes;
  std::vector<double> lengths;  // (num_borders) [m]
  int num_vertices = 0;         // including those of divided edges

  /// The edge at a node, towards the next one if there is one.
  const BorderEdge& edge_at(const BorderNode& n) const {
    return edges[n.edge < 0 ? nodes[n.previous].edge : n.edge];
  }

  /// End of the node's part on its edge [1].
  double end_of(int node) const {
    const BorderNode& next = nodes[nodes[node].next];
    return next.t > 0 ? next.t : 1;
  }

  /// Inserts a node at t of the node's edge, between the node and the next one.
  int divide(int node, double t);

  /// Distance along the border, the shorter way [m].
  double distance_along(int node_a, int node_b) const;
};

Borders build_borders(const TriangleMesh& mesh);

}  // namespace weft::engine
