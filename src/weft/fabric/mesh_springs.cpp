#include "weft/fabric/mesh_springs.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "weft/fabric/spring_warnings.h"

namespace weft::engine {
namespace {

constexpr int kMaxSweeps = 1000;
constexpr double kSettled = 1e-4;  // of the stiffest edge
constexpr double kSmallness =
    1e-4;  // weight of k² (regularisation), for edges that the fabric leaves undetermined

/// An edge's C per stiffness in the triangles on one side of it.
struct Side {
  int triangle = 0;
  Mat3 part = Mat3::Zero();  // share l² a aᵀ [m²]
};

/// Of each edge; a side without a triangle is zero.
std::vector<std::array<Side, 2>> find_sides(const RestMesh& mesh, const WarpField& warp,
                                            const std::vector<Edge>& edges) {
  std::vector<std::array<Side, 2>> sides(edges.size());
  const auto find_edge = [&](int i, int j) {
    const std::pair key = std::minmax(i, j);
    const auto before = [](const Edge& e, const std::pair<int, int>& k) { return std::pair(e.a, e.b) < k; };
    return std::lower_bound(edges.begin(), edges.end(), std::pair<int, int>(key), before) - edges.begin();
  };
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const auto& [i, j, k] = mesh.triangles[t];
    const TriangleCorners x = mesh.corners(t);
    const Vec3 weft = (x[1] - x[0]).cross(x[2] - x[0]).normalized().cross(warp.warp[t]);
    for (const auto& [p, q] : {std::pair(i, j), std::pair(j, k), std::pair(k, i)}) {
      const Vec3 edge = mesh.between(t, p, q);
      const double along = edge.dot(warp.warp[t]), across = edge.dot(weft);
      const Vec3 a = Vec3(along * along, across * across, along * across) / edge.norm();
      const auto e = find_edge(p, q);
      const int side = sides[e][0].part.isZero() ? 0 : 1;
      sides[e][side] = {t, a * a.transpose() / edges[e].num_triangles};
    }
  }
  return sides;
}

/// Contribution of an edge, per stiffness, to the scaled C around a vertex.
struct Column {
  int vertex = 0;
  Mat3 part;
};

/// Non-negative least squares, k >= 0, by coordinate descent over the edges.
class Fit {
 public:
  Fit(const std::vector<std::vector<Column>>& columns, const Mat3& target, int num_vertices)
      : columns_(columns), rest_(num_vertices, target) {
    for (const std::vector<Column>& column : columns) {
      double square = 0;
      for (const Column& c : column) square += c.part.squaredNorm();
      square_.push_back(square);
    }
    stiffness_.assign(columns.size(), 0.0);
  }

  std::vector<double> solve() {
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
      double moved = 0, largest = 0;
      for (std::size_t e = 0; e < columns_.size(); ++e) {
        moved = std::max(moved, std::abs(improve(e)));
        largest = std::max(largest, stiffness_[e]);
      }
      if (moved <= kSettled * largest) break;
    }
    return stiffness_;
  }

 private:
  double improve(std::size_t e) {
    if (square_[e] == 0) return 0;
    double gain = 0;
    for (const Column& c : columns_[e]) gain += c.part.cwiseProduct(rest_[c.vertex]).sum();
    const double before = stiffness_[e], smallness = kSmallness * square_[e];
    const double best = (gain + square_[e] * before) / (square_[e] + smallness);
    stiffness_[e] = std::max(0.0, best);
    for (const Column& c : columns_[e]) rest_[c.vertex] -= (stiffness_[e] - before) * c.part;
    return stiffness_[e] - before;
  }

  const std::vector<std::vector<Column>>& columns_;
  std::vector<Mat3> rest_;  // residual of the target
  std::vector<double> square_, stiffness_;
};

}  // namespace

MeshSprings make_mesh_springs(const RestMesh& mesh, const WarpField& warp, const Fabric& fabric,
                              const std::string& name) {
  const std::vector<Edge> edges = build_edges(mesh);
  const std::vector<std::array<Side, 2>> sides = find_sides(mesh, warp, edges);
  std::vector<double> around(mesh.num_vertices(), 0.0);  // areas of the triangles of each vertex
  double total = 0;
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    total += triangle_area(mesh, t);
    for (const int v : mesh.triangles[t]) around[v] += triangle_area(mesh, t);
  }
  Fabric forced = fabric;
  forced.c12 = fabric.g;
  const Vec3 scale = Vec3(fabric.c11, fabric.c22, fabric.g).cwiseSqrt().cwiseInverse();
  const Mat3 target = scale.asDiagonal() * membrane_stiffness(forced) * scale.asDiagonal();
  std::vector<std::vector<Column>> columns(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    for (const Side& side : sides[e]) {
      if (side.part.isZero()) continue;
      for (const int v : mesh.triangles[side.triangle])
        columns[e].push_back({v, scale.asDiagonal() * side.part * scale.asDiagonal() / around[v]});
    }
  }
  MeshSprings springs;
  springs.stiffness = Fit(columns, target, mesh.num_vertices()).solve();
  for (std::size_t e = 0; e < edges.size(); ++e)
    springs.mean += springs.stiffness[e] * (sides[e][0].part + sides[e][1].part) / total;
  springs.warnings = warn_of_springs(fabric, name);
  const Mat3& c = springs.mean;
  springs.warnings.push_back(
      "fabric \"" + name + "\": springs on this mesh give c11 = " + short_text(c(0, 0)) +
      ", c22 = " + short_text(c(1, 1)) + ", c12 = g = " + short_text(c(2, 2)) +
      " N/m on average instead of " + short_text(fabric.c11) + ", " + short_text(fabric.c22) + " and " +
      short_text(fabric.g) + "; membrane = \"triangle\" is exact");
  return springs;
}

}  // namespace weft::engine
