#pragma once
/// Private to mesh/: triangles divided at points on their edges.
///
///            c                       c
///           / \                     /|\      with one point
///          /   \         →         / | \     on one edge
///         /     \                 /  |  \    …
///        a---p---b               a---p---b
///
/// One point on an edge: two triangles; several: a fan. Points on two or three edges: the triangle is cut at
/// one of them, and what is left in the same way.

#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// A point inside the edge a–b.
struct EdgePoint {
  int a = 0, b = 0;
  double t = 0;    // at (1 − t) a + t b, in (0, 1) [1]
  int vertex = 0;  // the index that it gets
};

/// Triangles and where they come from.
struct DividedTriangles {
  std::vector<Triangle> triangles;
  std::vector<int> source;             // (num_triangles) of which triangle each is a part
  std::vector<CornerWeights> weights;  // (num_triangles) where its corners lie in that one
};

/// Every triangle as a part of itself.
DividedTriangles make_undivided(const std::vector<Triangle>& triangles);

/// Divides all triangles at an edge with points, however many triangles that are. Deterministic; the points
/// may come in any order.
DividedTriangles divide_edges(const DividedTriangles& whole, std::vector<EdgePoint> points);

}  // namespace weft::engine
