#include "weft/fabric/elements.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

namespace weft::engine {
namespace {

constexpr double kMinSine = 1e-6;  // minimum for the angle between a direction and a triangle's normal

Vec3 normal_of(const TriangleCorners& p) { return (p[1] - p[0]).cross(p[2] - p[0]); }

/// Projection on the plane of the triangle, normalised, or zero.
Vec3 project(const Vec3& direction, const Vec3& normal) {
  const Vec3 n = normal.normalized();
  const Vec3 flat = direction - direction.dot(n) * n;
  return flat.norm() > kMinSine * direction.norm() ? Vec3(flat.normalized()) : Vec3(Vec3::Zero());
}

Vec3 any_axis(const Vec3& normal) {
  const Vec3 x = project(Vec3::UnitX(), normal);
  return x.norm() > 0.5 ? x : project(Vec3::UnitZ(), normal);
}

/// ∂x/∂u at constant v, up to a positive factor.
Vec3 along_u(const TriangleCorners& p, const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 ab = b - a, ac = c - a;
  const double area = ab.x() * ac.y() - ab.y() * ac.x();
  return ((p[1] - p[0]) * ac.y() - (p[2] - p[0]) * ab.y()) * (area < 0 ? -1.0 : 1.0) *
         (area != 0 ? 1.0 : 0.0);
}

}  // namespace

WarpField warp_from_uv(const RestMesh& mesh, const std::vector<Vec2>& uv) {
  std::vector<CornerUv> by_corner;
  for (const auto& [a, b, c] : mesh.triangles) by_corner.push_back({uv[a], uv[b], uv[c]});
  return warp_from_uv(mesh, by_corner);
}

WarpField warp_from_uv(const RestMesh& mesh, const std::vector<CornerUv>& uv) {
  WarpField field;
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const TriangleCorners p = mesh.corners(t);
    const Vec3 direction = along_u(p, uv[t][0], uv[t][1], uv[t][2]);
    const bool is_given = direction.allFinite() && direction.norm() > 0;
    field.warp.push_back(is_given ? Vec3(direction.normalized()) : any_axis(normal_of(p)));
    field.num_guessed += !is_given;
  }
  return field;
}

WarpField warp_from_direction(const RestMesh& mesh, const Vec3& direction) {
  WarpField field;
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const Vec3 normal = normal_of(mesh.corners(t));
    const Vec3 warp = project(direction, normal);
    const bool is_given = warp.norm() > 0.5;
    field.warp.push_back(is_given ? warp : any_axis(normal));
    field.num_guessed += !is_given;
  }
  return field;
}

void scale_rest(RestMesh& mesh, const WarpField& warp, const std::vector<Vec2>& factors) {
  std::vector<TriangleCorners> scaled;
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec2 factor = (factors[a] + factors[b] + factors[c]) / 3;
    TriangleCorners p = mesh.corners(t);
    const Vec3 axis_1 = warp.warp[t], axis_2 = normal_of(p).normalized().cross(axis_1);
    const Vec3 origin = p[0];
    for (Vec3& x : p) {
      const Vec3 d = x - origin;
      x = origin + factor.x() * d.dot(axis_1) * axis_1 + factor.y() * d.dot(axis_2) * axis_2;
    }
    scaled.push_back(p);
  }
  mesh.at_rest = std::move(scaled);
}

Mat3 membrane_stiffness(const Fabric& fabric) {
  Mat3 c = Mat3::Zero();
  c(0, 0) = fabric.c11;
  c(1, 1) = fabric.c22;
  c(0, 1) = c(1, 0) = fabric.c12;
  c(2, 2) = fabric.g;
  return c;
}

std::vector<MembraneElement> build_membranes(const RestMesh& mesh, const WarpField& warp) {
  std::vector<MembraneElement> membranes;
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const TriangleCorners p = mesh.corners(t);
    const Vec3 axis_1 = warp.warp[t], axis_2 = normal_of(p).normalized().cross(axis_1);
    const auto flat = [&](const Vec3& x) { return Vec2((x - p[0]).dot(axis_1), (x - p[0]).dot(axis_2)); };
    membranes.push_back({mesh.triangles[t], make_rest_triangle(flat(p[0]), flat(p[1]), flat(p[2]))});
  }
  return membranes;
}

namespace {

/// Two triangles that may be a pair.
struct Candidate {
  int first = 0, second = 0;  // triangles
  double squareness = 0;      // |edge|² over their area, at most 2: the diagonal of a square [1]
};

/// The position in a triangle at which the edge from a to b begins; -1: nowhere.
int find_edge(const Triangle& triangle, int a, int b) {
  for (int c = 0; c < 3; ++c) {
    if (triangle[c] == a && triangle[(c + 1) % 3] == b) return c;
  }
  return -1;
}

std::vector<Candidate> find_candidates(const RestMesh& mesh, const WarpField& warp,
                                       const std::vector<MembraneElement>& membranes) {
  constexpr double kSameWarp = 0.94;                       // cosine of 20 degrees
  std::map<std::pair<int, int>, std::vector<int>> around;  // triangles of each edge
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const Triangle& v = mesh.triangles[t];
    for (int c = 0; c < 3; ++c) around[std::minmax(v[c], v[(c + 1) % 3])].push_back(t);
  }
  std::vector<Candidate> candidates;
  for (const auto& [edge, triangles] : around) {
    if (triangles.size() != 2) continue;
    const auto& [a, b] = edge;
    const int s = triangles[0], t = triangles[1];
    const bool is_oriented =
        (find_edge(mesh.triangles[s], a, b) >= 0) != (find_edge(mesh.triangles[t], a, b) >= 0);
    if (!is_oriented) continue;
    // Warp in the axes along the edge and across it, in each triangle's plane.
    const auto in_plane = [&, a = a, b = b](int k) {
      const Vec3 along = mesh.between(k, a, b).normalized();
      const Vec3 across = normal_of(mesh.corners(k)).normalized().cross(along);
      return Vec2(warp.warp[k].dot(along), warp.warp[k].dot(across));
    };
    if (in_plane(s).dot(in_plane(t)) < kSameWarp) continue;
    const double length_sq =
        0.5 * (mesh.between(s, a, b).squaredNorm() + mesh.between(t, a, b).squaredNorm());
    candidates.push_back(
        {s, t, std::min(2.0, length_sq / (membranes[s].rest.area + membranes[t].rest.area))});
  }
  std::ranges::stable_sort(candidates, std::greater<>(), &Candidate::squareness);
  return candidates;
}

/// Partner of each triangle, -1: none. Greedy by squareness; then triangles without a partner get one where two
/// of them are joined by a pair, which is exchanged for two pairs.
std::vector<int> match(const std::vector<Candidate>& candidates, int num_triangles) {
  std::vector<int> partner(static_cast<std::size_t>(num_triangles), -1);
  const auto pair = [&](int s, int t) {
    partner[s] = t;
    partner[t] = s;
  };
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(num_triangles));
  for (const auto& [s, t, squareness] : candidates) {
    neighbours[s].push_back(t);
    neighbours[t].push_back(s);
    if (partner[s] < 0 && partner[t] < 0) pair(s, t);
  }
  const auto exchange = [&](int t) {
    for (const int a : neighbours[t]) {
      const int b = partner[a];
      for (const int free : neighbours[b]) {
        if (free == t || partner[free] >= 0) continue;
        pair(t, a);
        pair(b, free);
        return;
      }
    }
  };
  for (int t = 0; t < num_triangles; ++t) {
    if (partner[t] < 0) exchange(t);
  }
  return partner;
}

MembranePatch make_single(const MembraneElement& membrane, int index) {
  const auto& [a, b, c] = membrane.vertices;
  return {.num_triangles = 1,
          .vertices = {a, b, c, -1},
          .triangles = {index, -1},
          .corners = {{{0, 1, 2}, {0, 0, 0}}},
          .rest = {membrane.rest, {}}};
}

/// The second triangle's corner that is not in the first one becomes vertex 3.
MembranePatch make_pair(const std::vector<MembraneElement>& membranes, int first, int second) {
  MembranePatch patch = make_single(membranes[first], first);
  patch.num_triangles = 2;
  patch.triangles[1] = second;
  patch.rest[1] = membranes[second].rest;
  for (int c = 0; c < 3; ++c) {
    const int vertex = membranes[second].vertices[c];
    const auto found = std::find(patch.vertices.begin(), patch.vertices.begin() + 3, vertex);
    patch.corners[1][c] = static_cast<int>(found - patch.vertices.begin());
    patch.vertices[patch.corners[1][c]] = vertex;
  }
  return patch;
}

}  // namespace

std::vector<MembranePatch> make_single_patches(const std::vector<MembraneElement>& membranes) {
  std::vector<MembranePatch> patches;
  for (std::size_t t = 0; t < membranes.size(); ++t)
    patches.push_back(make_single(membranes[t], static_cast<int>(t)));
  return patches;
}

std::vector<MembranePatch> pair_triangles(const RestMesh& mesh, const WarpField& warp,
                                          const std::vector<MembraneElement>& membranes) {
  const std::vector<int> partner = match(find_candidates(mesh, warp, membranes), mesh.num_triangles());
  std::vector<MembranePatch> patches;
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    if (partner[t] < 0)
      patches.push_back(make_single(membranes[t], t));
    else if (partner[t] > t)
      patches.push_back(make_pair(membranes, t, partner[t]));
  }
  return patches;
}

std::vector<HingeElement> build_hinges(const RestMesh& mesh, const WarpField& warp, const Fabric& fabric) {
  std::vector<HingeElement> hinges;
  for (const Edge& e : build_edges(mesh)) {
    if (e.num_triangles != 2 || e.opposite[0] == e.opposite[1]) continue;
    double rigidity = 0, area = 0, length_sq = 0;
    for (const int t : e.triangles) {
      const Vec3 edge = mesh.between(t, e.a, e.b);
      length_sq += 0.5 * edge.squaredNorm();
      // Bending is across the edge: the cosine of its direction to warp is the edge's sine.
      const double along = edge.normalized().dot(warp.warp[t]);
      const double across = std::sqrt(std::max(0.0, 1 - along * along));
      rigidity += 0.5 * bending_rigidity(fabric, across, along);
      area += triangle_area(mesh, t);
    }
    hinges.push_back({{e.a, e.b, e.opposite[0], e.opposite[1]},
                      {e.triangles[0], e.triangles[1]},
                      rigidity * length_sq / area});
  }
  return hinges;
}

}  // namespace weft::engine
