#pragma once
/// Private to mesh/: the borders of a mesh as polylines that can be divided.
///
///         o-----o-----o         Border edges are those of exactly one triangle. A border is closed, unless
///         it meets
///        / \   / \   / \        an edge of more than two triangles. It runs around the triangles whichever
///        way they
///       1---2-*-3---4---5       face; a vertex at which two borders touch has a node in each.
///         →     * a divided edge: a node without a vertex of the mesh

#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// A border edge of the mesh, in the border's direction.
struct BorderEdge {
  int a = 0, b = 0;            // vertices
  int triangle = 0;            // the one at it
  int border = 0, piece = 0;   // which border, which connected component it belongs to
  double arc = 0;              // length of the border before it [m]
  double length = 0;           // [m]
  Vec3 tangent, inward, side;  // from a to b; into the triangle; tangent × inward; unit vectors
};

/// A point of a border, and the part of an edge from it to the next node.
struct BorderNode {
  int vertex = 0;  // of the mesh; those of divided edges count on from its number of vertices
  int edge = -1;   // the BorderEdge it is on, towards the next node; -1 at the end of an open border
  double t = 0;    // where on that edge, 0 at a vertex of the mesh [1]
  int previous = -1, next = -1;
  Vec3 position;  // [m]
};

struct Borders {
  std::vector<BorderEdge> edges;
  std::vector<BorderNode> nodes;
  std::vector<double> lengths;  // (num_borders) [m]
  int num_vertices = 0;         // of the mesh and of divided edges

  int piece_of(const BorderNode& n) const {
    return edges[n.edge < 0 ? nodes[n.previous].edge : n.edge].piece;
  }

  /// Where on its edge the part that begins at the node ends [1].
  double end_of(int node) const {
    const BorderNode& next = nodes[nodes[node].next];
    return next.t > 0 ? next.t : 1;
  }

  /// A new node at t of the node's edge, between the node and the next one.
  int divide(int node, double t);

  /// Along the border, the shorter way [m].
  double distance_along(int node_a, int node_b) const;
};

Borders build_borders(const TriangleMesh& mesh);

}  // namespace weft::engine
