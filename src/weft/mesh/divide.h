#pragma once
/// Private to mesh/: triangles divided at points on their edges.
///
///            c                       c
///           / \                     /|\      with one point
///          /   \         →         / | \     on one edge
///         /     \                 /  |  \    …
///        a---p---b               a---p---b
///
/// One point on an edge: two triangles; several: a triangle fan. Points on two or three edges: the triangle
/// is cut at one of them, and the parts likewise.

#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// A point inside the edge a–b.
struct EdgePoint {
  int a = 0, b = 0;
  double t = 0;    // at (1 − t) a + t b, in (0, 1) [1]
  int vertex = 0;  // its vertex index
};

/// Triangles and their origin.
struct DividedTriangles {
  std::vector<Triangle> triangles;
  std::vector<int> source;             // (num_triangles) original triangle of each part
  std::vector<CornerWeights> weights;  // (num_triangles) positions of its corners in that one
};

/// Every triangle as its own single part.
DividedTriangles make_undivided(const std::vector<Triangle>& triangles);

/// Divides all triangles at edges with points, any number per edge. Deterministic; the points may come in any
/// order.
DividedTriangles divide_edges(const DividedTriangles& whole, std::vector<EdgePoint> points);

}  // namespace weft::engine
