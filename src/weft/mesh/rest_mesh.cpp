#include "weft/mesh/rest_mesh.h"

#include <algorithm>
#include <cmath>

#include "weft/mesh/slivers.h"

namespace weft::engine {
namespace {

using Eigen::Vector2d;

/// A triangle in its own plane: its first corner at the origin, the second along the first axis.
std::array<Vector2d, 2> lay_flat(const TriangleCorners& p) {
  const Vec3 d1 = p[1] - p[0], d2 = p[2] - p[0];
  const double length = d1.norm();
  return {Vector2d(length, 0), Vector2d(d1.dot(d2) / length, d1.cross(d2).norm() / length)};
}

/// `given` in the plane of `own`, turned by the rotation of the deformation from one to the other.
TriangleCorners place(const TriangleCorners& given, const TriangleCorners& own) {
  const auto from = lay_flat(given), to = lay_flat(own);
  // The deformation is [[a, b], [0, d]]; the rotation of its polar decomposition is along (a + d, −b).
  const double a = to[0].x() / from[0].x(), d = to[1].y() / from[1].y(),
               b = (to[1].x() - a * from[1].x()) / from[1].y();
  const double size = std::sqrt((a + d) * (a + d) + b * b), cosine = (a + d) / size, sine = -b / size;
  const Vec3 axis_1 = (own[1] - own[0]).normalized();
  const Vec3 axis_2 = (own[1] - own[0]).cross(own[2] - own[0]).normalized().cross(axis_1);
  TriangleCorners placed = {own[0], own[0], own[0]};
  for (int k = 0; k < 2; ++k) {
    placed[k + 1] += (cosine * from[k].x() - sine * from[k].y()) * axis_1 +
                     (sine * from[k].x() + cosine * from[k].y()) * axis_2;
  }
  return placed;
}

}  // namespace

double triangle_area(const RestMesh& mesh, int t) {
  const TriangleCorners p = mesh.corners(t);
  return 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm();
}

std::vector<double> compute_vertex_areas(const RestMesh& mesh) {
  std::vector<double> areas(mesh.positions.size(), 0.0);
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const double third = triangle_area(mesh, t) / 3;
    for (const int v : mesh.triangles[t]) areas[v] += third;
  }
  return areas;
}

double edge_length(const RestMesh& mesh, const Edge& edge) {
  const double first = mesh.between(edge.triangles[0], edge.a, edge.b).norm();
  if (edge.num_triangles == 1) return first;
  return 0.5 * (first + mesh.between(edge.triangles[1], edge.a, edge.b).norm());
}

bool has_area(const TriangleCorners& p) {
  const Vec3 d1 = p[1] - p[0], d2 = p[2] - p[0];
  const double twice_area = d1.cross(d2).norm(),
               longest_sq = std::max({d1.squaredNorm(), d2.squaredNorm(), (d2 - d1).squaredNorm()});
  return std::isfinite(longest_sq) && longest_sq > 0 && twice_area >= SliverLimits().flatness * longest_sq;
}

int set_rest(RestMesh& mesh, const std::vector<TriangleCorners>& given) {
  mesh.at_rest.clear();
  std::vector<TriangleCorners> at_rest;
  int num_kept = 0;
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const TriangleCorners own = mesh.corners(t);
    const bool is_given = has_area(given[t]);
    at_rest.push_back(is_given ? place(given[t], own) : own);
    num_kept += !is_given;
  }
  mesh.at_rest = std::move(at_rest);
  return num_kept;
}

}  // namespace weft::engine
