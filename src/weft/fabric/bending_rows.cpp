#include "weft/fabric/bending_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace weft::engine {
namespace {

constexpr double kPi = 3.141592653589793;
constexpr double kHingeShare = 0.02;   // rigidity share of the hinges that supplement stencils
constexpr double kCornerCosine = 0.7;  // cosine of the border's turn below which a vertex is a corner

double twist_rigidity(const Fabric& f) { return std::max(0.0, 4 * f.bend_bias - f.bend_warp - f.bend_weft); }

void add_row(BendingRows& rows, double stiffness, std::initializer_list<std::pair<int, double>> entries) {
  if (stiffness <= 0) return;
  for (const auto& [vertex, weight] : entries) {
    rows.vertex.push_back(vertex);
    rows.weight.push_back(weight);
  }
  rows.begin.push_back(static_cast<int>(rows.vertex.size()));
  rows.stiffness.push_back(stiffness);
}

/// Second derivatives x,11 x,22 x,12 at a vertex, each a linear combination of vertices.
using Combination = std::map<int, double>;
struct CurvatureStencil {
  std::array<Combination, 3> derivative;  // [1/m²]
  Mat3 form = Mat3::Zero();               // energy ½ kᵀ form k of the three, area included [N·m³]
};

/// Splits the form into independent rows: form = Σ_c d_c l_c l_cᵀ (square-root-free Cholesky).
void add_stencil(BendingRows& rows, const CurvatureStencil& stencil) {
  Mat3 rest = stencil.form;
  for (int c = 0; c < 3; ++c) {
    const double pivot = rest(c, c);
    if (pivot <= 1e-14 * stencil.form.diagonal().maxCoeff()) continue;
    const Vec3 l = rest.col(c) / pivot;
    rest -= pivot * l * l.transpose();
    Combination row;
    for (int k = 0; k < 3; ++k) {
      for (const auto& [vertex, weight] : stencil.derivative[k]) row[vertex] += l[k] * weight;
    }
    for (const auto& [vertex, weight] : row) {
      rows.vertex.push_back(vertex);
      rows.weight.push_back(weight);
    }
    rows.begin.push_back(static_cast<int>(rows.vertex.size()));
    rows.stiffness.push_back(pivot);
  }
}

/// One-ring of an inner vertex: its triangles in order, and the vertices between them.
struct Ring {
  std::vector<int> triangles;
  std::vector<int> vertices;  // vertices[k], vertices[k + 1] and the centre make triangles[k]
};

/// Neighbours of each vertex of a mesh.
class Neighbourhood {
 public:
  explicit Neighbourhood(const TriangleMesh& mesh) : mesh_(mesh), around_(mesh.positions.size()) {
    for (int t = 0; t < mesh.num_triangles(); ++t) {
      for (const int v : mesh.triangles[t]) around_[v].push_back(t);
    }
  }

  /// Empty for border and non-manifold vertices, and where triangles are oriented inconsistently.
  Ring ring(int center) const {
    Ring ring;
    const std::vector<int>& around = around_[center];
    if (around.empty()) return ring;
    int t = around.front();
    do {
      ring.triangles.push_back(t);
      ring.vertices.push_back(next_corner(t, center, 1));
      t = triangle_from(center, next_corner(t, center, 2));
    } while (t >= 0 && t != around.front() && ring.triangles.size() <= around.size());
    const bool is_closed = t == around.front() && ring.triangles.size() == around.size();
    return is_closed ? ring : Ring();
  }

 private:
  /// The corner `steps` after `center` in the triangle's orientation.
  int next_corner(int t, int center, int steps) const {
    const Triangle& v = mesh_.triangles[t];
    const int at = v[0] == center ? 0 : v[1] == center ? 1 : 2;
    return v[(at + steps) % 3];
  }

  /// The only triangle in which `from` follows `center`, -1 if there is none or more than one.
  int triangle_from(int center, int from) const {
    int found = -1;
    for (const int t : around_[center]) {
      if (next_corner(t, center, 1) != from) continue;
      if (found >= 0) return -1;
      found = t;
    }
    return found;
  }

  const TriangleMesh& mesh_;
  std::vector<std::vector<int>> around_;
};

/// A vertex's one-ring flattened: angles around the vertex scaled to a sum of 360°, distances from it kept.
struct FlatRing {
  std::vector<double> angle;   // of each ring vertex, from the first one
  std::vector<double> length;  // of the edge to it [m]
  double scale = 1;            // of angles
  Vec3 axis, across;           // of the frame in space: towards the first ring vertex, and 90° on
};

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

FlatRing lay_flat(const TriangleMesh& mesh, int center, const Ring& ring) {
  FlatRing flat;
  const auto spoke = [&](std::size_t k) -> Vec3 {
    return mesh.positions[ring.vertices[k % ring.vertices.size()]] - mesh.positions[center];
  };
  double total = 0;
  Vec3 normal = Vec3::Zero();
  for (std::size_t k = 0; k < ring.vertices.size(); ++k) {
    flat.angle.push_back(total);
    flat.length.push_back(spoke(k).norm());
    total += angle_between(spoke(k), spoke(k + 1));
    normal += spoke(k).cross(spoke(k + 1));
  }
  flat.scale = 2 * kPi / total;
  for (double& a : flat.angle) a *= flat.scale;
  flat.axis = (spoke(0) - spoke(0).dot(normal) * normal / normal.squaredNorm()).normalized();
  flat.across = normal.normalized().cross(flat.axis);
  return flat;
}

/// The warp's angle in the flat ring: mean over its triangles, by area, of undirected axes.
double warp_angle(const TriangleMesh& mesh, int center, const Ring& ring, const FlatRing& flat,
                  const WarpField& warp) {
  double c = 0, s = 0;
  for (std::size_t k = 0; k < ring.triangles.size(); ++k) {
    const int t = ring.triangles[k];
    const auto& [i, j, l] = mesh.triangles[t];
    const Vec3 normal = (mesh.positions[j] - mesh.positions[i]).cross(mesh.positions[l] - mesh.positions[i]);
    const Vec3 spoke = (mesh.positions[ring.vertices[k]] - mesh.positions[center]).normalized();
    const double cosine = spoke.dot(warp.warp[t]);
    const double sine = normal.normalized().dot(spoke.cross(warp.warp[t]));
    const double doubled = 2 * (flat.angle[k] + std::atan2(sine, cosine));
    c += normal.norm() * std::cos(doubled);
    s += normal.norm() * std::sin(doubled);
  }
  return 0.5 * std::atan2(s, c);
}

/// −Σ_j (∫ ∂a φ_i ∂b φ_j) x_j / A_i over the flat ring, with warp as the first axis; A_i in `area`.
std::array<Combination, 3> second_derivatives(int center, const Ring& ring, const FlatRing& flat,
                                              double warp_at, double& area) {
  const std::size_t n = ring.vertices.size();
  std::vector<Vec2> place;
  for (std::size_t k = 0; k < n; ++k) {
    const double at = flat.angle[k] - warp_at;
    place.push_back(flat.length[k] * Vec2(std::cos(at), std::sin(at)));
  }
  std::array<Combination, 3> derivative;
  area = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const RestTriangle rest = make_rest_triangle(Vec2::Zero(), place[k], place[(k + 1) % n]);
    const int vertices[3] = {center, ring.vertices[k], ring.vertices[(k + 1) % n]};
    const Vec2& gi = rest.gradient[0];
    for (int c = 0; c < 3; ++c) {
      const Vec2& gj = rest.gradient[c];
      derivative[0][vertices[c]] -= rest.area * gi.x() * gj.x();
      derivative[1][vertices[c]] -= rest.area * gi.y() * gj.y();
      derivative[2][vertices[c]] -= 0.5 * rest.area * (gi.x() * gj.y() + gi.y() * gj.x());
    }
    area += rest.area / 3;
  }
  for (Combination& combination : derivative) {
    for (auto& [vertex, weight] : combination) weight /= area;
  }
  return derivative;
}

/// A border vertex that bends along the border with its inner neighbours.
struct BorderVertex {
  Vec3 tangent = Vec3::Zero();  // unit, or zero at corners
  double area = 0;              // its share for each inner neighbour [m²]
};

std::vector<BorderVertex> find_border(const TriangleMesh& mesh, const std::vector<Ring>& rings) {
  std::vector<Vec3> first(mesh.positions.size(), Vec3::Zero()), last = first;
  std::vector<int> num_inner(mesh.positions.size(), 0);
  for (const Edge& e : build_edges(mesh)) {
    const bool inner_a = !rings[e.a].triangles.empty(), inner_b = !rings[e.b].triangles.empty();
    num_inner[e.a] += inner_b;
    num_inner[e.b] += inner_a;
    if (e.num_triangles != 1) continue;
    const Vec3 along = (mesh.positions[e.b] - mesh.positions[e.a]).normalized();
    (first[e.a].norm() == 0 ? first : last)[e.a] = along;
    (first[e.b].norm() == 0 ? first : last)[e.b] = -along;
  }
  const std::vector<double> areas = compute_vertex_areas(mesh);
  std::vector<BorderVertex> border(mesh.positions.size());
  for (std::size_t v = 0; v < border.size(); ++v) {
    if (first[v].norm() == 0 || last[v].norm() == 0 || num_inner[v] == 0) continue;
    if (first[v].dot(-last[v]) < kCornerCosine) continue;
    border[v] = {(first[v] - last[v]).normalized(), areas[v] / num_inner[v]};
  }
  return border;
}

CurvatureStencil make_stencil(const TriangleMesh& mesh, int center, const Ring& ring, const WarpField& warp,
                              const Fabric& fabric, const std::vector<BorderVertex>& border) {
  const FlatRing flat = lay_flat(mesh, center, ring);
  const double warp_at = warp_angle(mesh, center, ring, flat, warp);
  CurvatureStencil stencil;
  double area = 0;
  stencil.derivative = second_derivatives(center, ring, flat, warp_at, area);
  stencil.form.diagonal() =
      (1 - kHingeShare) * area * Vec3(fabric.bend_warp, fabric.bend_weft, twist_rigidity(fabric));
  for (const int v : ring.vertices) {
    if (border[v].area == 0) continue;
    const double at = std::atan2(border[v].tangent.dot(flat.across), border[v].tangent.dot(flat.axis));
    const double c = std::cos(at - warp_at), s = std::sin(at - warp_at);
    const Vec3 along(c * c, s * s, 2 * c * s);  // κ along the border = along · (x,11 x,22 x,12)
    stencil.form +=
        (1 - kHingeShare) * border[v].area * bending_rigidity(fabric, c, s) * along * along.transpose();
  }
  return stencil;
}

/// Hinges, linearised at rest: with full rigidity if no stencil reaches a vertex next to the edge, else with
/// a small share, so that small or narrow meshes have no bending mode of zero energy.
void add_hinges(BendingRows& rows, const TriangleMesh& mesh, const WarpField& warp, const Fabric& fabric) {
  std::vector<char> is_reached(mesh.positions.size(), 0);
  for (const int v : rows.vertex) is_reached[v] = 1;
  for (const HingeElement& hinge : build_hinges(mesh, warp, fabric)) {
    const auto& [a, b, p, q] = hinge.vertices;
    const double share = is_reached[p] && is_reached[q] ? kHingeShare : 1.0;
    const Vec3 origin = mesh.positions[a], edge = mesh.positions[b] - origin;
    double weight[4] = {0, 0, 0, 0};
    for (const int side : {2, 3}) {
      const Vec3 tip = mesh.positions[hinge.vertices[side]] - origin;
      const double along = tip.dot(edge) / edge.squaredNorm();
      weight[side] = 1 / (tip - along * edge).norm();
      weight[0] -= (1 - along) * weight[side];
      weight[1] -= along * weight[side];
    }
    // A row is the angle per edge length, like a curvature; the stiffness compensates.
    const double length = edge.norm();
    add_row(
        rows, share * hinge.stiffness * length * length,
        {{a, weight[0] / length}, {b, weight[1] / length}, {p, weight[2] / length}, {q, weight[3] / length}});
  }
}

}  // namespace

BendingRows build_grid_bending(const Grid& grid, GridWarp warp, const Fabric& fabric) {
  BendingRows rows;
  const bool is_first = warp == GridWarp::first_axis;
  const double along_x = is_first ? fabric.bend_warp : fabric.bend_weft;
  const double along_z = is_first ? fabric.bend_weft : fabric.bend_warp;
  const double dx = grid.spacing_x(), dz = grid.spacing_z(), area = dx * dz;
  const double wx = 1 / (dx * dx), wz = 1 / (dz * dz), wt = 1 / area;
  for (int j = 0; j < grid.num_rows(); ++j) {
    for (int i = 0; i < grid.num_columns(); ++i) {
      const double share_z = j == 0 || j == grid.cells_z ? 0.5 : 1.0;
      const double share_x = i == 0 || i == grid.cells_x ? 0.5 : 1.0;
      if (i > 0 && i < grid.cells_x) {
        add_row(rows, along_x * area * share_z,
                {{grid.index(i - 1, j), wx}, {grid.index(i, j), -2 * wx}, {grid.index(i + 1, j), wx}});
      }
      if (j > 0 && j < grid.cells_z) {
        add_row(rows, along_z * area * share_x,
                {{grid.index(i, j - 1), wz}, {grid.index(i, j), -2 * wz}, {grid.index(i, j + 1), wz}});
      }
      if (i < grid.cells_x && j < grid.cells_z) {
        add_row(rows, twist_rigidity(fabric) * area,
                {{grid.index(i, j), wt},
                 {grid.index(i + 1, j), -wt},
                 {grid.index(i, j + 1), -wt},
                 {grid.index(i + 1, j + 1), wt}});
      }
    }
  }
  return rows;
}

BendingRows build_mesh_bending(const TriangleMesh& mesh, const WarpField& warp, const Fabric& fabric) {
  const Neighbourhood neighbourhood(mesh);
  std::vector<Ring> rings;
  for (int v = 0; v < mesh.num_vertices(); ++v) rings.push_back(neighbourhood.ring(v));
  const std::vector<BorderVertex> border = find_border(mesh, rings);
  BendingRows rows;
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (rings[v].triangles.empty()) continue;
    add_stencil(rows, make_stencil(mesh, v, rings[v], warp, fabric, border));
  }
  add_hinges(rows, mesh, warp, fabric);
  return rows;
}

BendingMatrix build_bending_matrix(const BendingRows& rows, int num_vertices) {
  std::vector<Combination> lines(num_vertices);
  for (int r = 0; r < rows.num_rows(); ++r) {
    for (int a = rows.begin[r]; a < rows.begin[r + 1]; ++a) {
      for (int b = rows.begin[r]; b < rows.begin[r + 1]; ++b) {
        lines[rows.vertex[a]][rows.vertex[b]] += rows.stiffness[r] * rows.weight[a] * rows.weight[b];
      }
    }
  }
  BendingMatrix matrix;
  matrix.begin.push_back(0);
  for (const Combination& line : lines) {
    for (const auto& [column, value] : line) {
      matrix.column.push_back(column);
      matrix.value.push_back(value);
    }
    matrix.begin.push_back(static_cast<int>(matrix.column.size()));
  }
  return matrix;
}

}  // namespace weft::engine
