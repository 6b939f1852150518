#include "weft/mesh/rest_triangle.h"

#include <cmath>

namespace weft::engine {

RestTriangle make_rest_triangle(const Vec2& x0, const Vec2& x1, const Vec2& x2) {
  const Vec2 edge[3] = {x2 - x1, x0 - x2, x1 - x0};  // opposite to each corner
  const double twice_area = edge[2].x() * -edge[1].y() + edge[2].y() * edge[1].x();
  RestTriangle rest;
  rest.area = std::abs(twice_area) / 2;
  for (int c = 0; c < 3; ++c) rest.gradient[c] = Vec2(-edge[c].y(), edge[c].x()) / twice_area;
  return rest;
}

RestTriangle make_rest_triangle(const RestMesh& mesh, int t) {
  const auto [a, b, c] = mesh.corners(t);
  const Vec3 d1 = b - a, d2 = c - a;
  const double length = d1.norm();
  return make_rest_triangle({0, 0}, {length, 0}, {d1.dot(d2) / length, d1.cross(d2).norm() / length});
}

}  // namespace weft::engine
