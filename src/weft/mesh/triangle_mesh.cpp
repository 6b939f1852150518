#include "weft/mesh/triangle_mesh.h"

#include <algorithm>
#include <string>

#include "weft/core/angle.h"
#include "weft/error.h"

namespace weft::engine {

CornerUv interpolate(const CornerUv& uv, const CornerWeights& weights) {
  CornerUv result;
  for (int corner = 0; corner < 3; ++corner) {
    result[corner].setZero();
    for (int k = 0; k < 3; ++k) {
      if (weights[corner][k] != 0) result[corner] += weights[corner][k] * uv[k];
    }
  }
  return result;
}

void require_valid(const TriangleMesh& mesh) {
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (!mesh.positions[v].allFinite()) {
      throw InputError("vertex " + std::to_string(v) + " has a non-finite coordinate");
    }
  }
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    for (const int v : mesh.triangles[t]) {
      if (v < 0 || v >= mesh.num_vertices()) {
        throw InputError("triangle " + std::to_string(t) + " uses vertex " + std::to_string(v) +
                         ", but the mesh has " + std::to_string(mesh.num_vertices()) + " vertices");
      }
    }
  }
  if (mesh.triangles.empty()) throw InputError("the mesh has no triangles");
}

double triangle_area(const TriangleMesh& mesh, int t) {
  const auto& [a, b, c] = mesh.triangles[t];
  const auto& p = mesh.positions;
  return 0.5 * (p[b] - p[a]).cross(p[c] - p[a]).norm();
}

std::vector<double> compute_vertex_areas(const TriangleMesh& mesh) {
  std::vector<double> areas(mesh.positions.size(), 0.0);
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    for (const int v : mesh.triangles[t]) areas[v] += triangle_area(mesh, t) / 3;
  }
  return areas;
}

std::vector<Edge> build_edges(const TriangleMesh& mesh) {
  // One half edge per side of a triangle, matched by sorting. The triangle's number breaks ties.
  struct HalfEdge {
    int a, b, opposite, triangle;
  };
  std::vector<HalfEdge> half_edges;
  half_edges.reserve(3 * mesh.triangles.size());
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const Triangle& tri = mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      const int p = tri[k], q = tri[(k + 1) % 3];
      half_edges.push_back({std::min(p, q), std::max(p, q), tri[(k + 2) % 3], t});
    }
  }
  std::sort(half_edges.begin(), half_edges.end(), [](const HalfEdge& l, const HalfEdge& r) {
    return std::array{l.a, l.b, l.triangle} < std::array{r.a, r.b, r.triangle};
  });

  std::vector<Edge> edges;
  for (const HalfEdge& h : half_edges) {
    if (edges.empty() || edges.back().a != h.a || edges.back().b != h.b)
      edges.push_back({h.a, h.b, {-1, -1}, 0});
    Edge& edge = edges.back();
    if (edge.num_triangles < 2) {
      edge.opposite[edge.num_triangles] = h.opposite;
      edge.triangles[edge.num_triangles] = h.triangle;
    }
    ++edge.num_triangles;
  }
  return edges;
}

TriangleMesh make_sphere_mesh(const Vec3& center, double radius, int rings) {
  TriangleMesh mesh;
  const int segments = 2 * rings;
  const auto index = [&](int ring, int segment) { return 1 + (ring - 1) * segments + segment % segments; };

  mesh.positions.push_back(center + radius * Vec3::UnitY());
  for (int r = 1; r < rings; ++r) {
    const SinCos polar = sin_cos_deg(180.0 * r / rings);
    for (int s = 0; s < segments; ++s) {
      const SinCos around = sin_cos_deg(360.0 * s / segments);
      mesh.positions.push_back(center +
                               radius * Vec3(polar.sin * around.sin, polar.cos, polar.sin * around.cos));
    }
  }
  const int south = mesh.num_vertices();
  mesh.positions.push_back(center - radius * Vec3::UnitY());

  for (int s = 0; s < segments; ++s) {
    mesh.triangles.push_back({0, index(1, s), index(1, s + 1)});
    for (int r = 1; r + 1 < rings; ++r) {
      mesh.triangles.push_back({index(r, s), index(r + 1, s), index(r + 1, s + 1)});
      mesh.triangles.push_back({index(r, s), index(r + 1, s + 1), index(r, s + 1)});
    }
    mesh.triangles.push_back({south, index(rings - 1, s + 1), index(rings - 1, s)});
  }
  return mesh;
}

TriangleMesh make_capsule_mesh(const Vec3& a, const Vec3& b, double radius, int rings) {
  // A sphere with an even number of rings, cut and pulled apart at its equatorial ring.
  const int half = std::max(rings / 2, 1), segments = 4 * half;
  const Vec3 axis = b - a;
  const Mat3 rotation = axis.norm() > 0
                            ? Eigen::Quaterniond::FromTwoVectors(Vec3::UnitY(), axis).toRotationMatrix()
                            : Mat3(Mat3::Identity());
  const TriangleMesh sphere = make_sphere_mesh(Vec3::Zero(), radius, 2 * half);
  TriangleMesh mesh;
  const int first_of_equator = 1 + (half - 1) * segments;
  const auto lower = [&](int v) { return v + segments; };
  for (int v = 0; v < sphere.num_vertices(); ++v) {
    if (v < first_of_equator + segments) mesh.positions.push_back(b + rotation * sphere.positions[v]);
  }
  for (int v = first_of_equator; v < sphere.num_vertices(); ++v) {
    mesh.positions.push_back(a + rotation * sphere.positions[v]);
  }
  const auto is_upper = [&](const Triangle& tri) {
    return std::any_of(tri.begin(), tri.end(), [&](int v) { return v < first_of_equator; });
  };
  for (const Triangle& tri : sphere.triangles) {
    mesh.triangles.push_back(is_upper(tri) ? tri : Triangle{lower(tri[0]), lower(tri[1]), lower(tri[2])});
  }
  for (int s = 0; s < segments; ++s) {
    const int p = first_of_equator + s, q = first_of_equator + (s + 1) % segments;
    mesh.triangles.push_back({p, lower(p), lower(q)});
    mesh.triangles.push_back({p, lower(q), q});
  }
  return mesh;
}

TriangleMesh make_box_mesh(const Vec3& center, const Vec3& half_size, const Mat3& rotation) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {1, -1}) {
      // normal, u and w are right-handed: the corners run counter-clockwise seen from outside.
      const Vec3 normal = side * half_size[axis] * Vec3::Unit(axis);
      const Vec3 u = half_size[(axis + 1) % 3] * Vec3::Unit((axis + 1) % 3);
      const Vec3 w = side * half_size[(axis + 2) % 3] * Vec3::Unit((axis + 2) % 3);
      const int first = mesh.num_vertices();
      for (const Vec3& corner :
           {Vec3(normal - u - w), Vec3(normal + u - w), Vec3(normal + u + w), Vec3(normal - u + w)}) {
        mesh.positions.push_back(center + rotation * corner);
      }
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    }
  }
  return mesh;
}

TriangleMesh make_square_mesh(const Vec3& point, const Vec3& normal, double side) {
  const Vec3 u = normal.unitOrthogonal() * (side / 2);
  const Vec3 w = normal.cross(u);
  return {{point - u - w, point + u - w, point + u + w, point - u + w}, {{0, 1, 2}, {0, 2, 3}}};
}

}  // namespace weft::engine
