#include "weft/fabric/bending_rows.h"

#include <algorithm>
#include <array>
#include <map>

#include "weft/core/angle.h"

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

/// Linear combination of vertices.
using Combination = std::map<int, double>;

/// Second derivatives x,11 x,22 x,12 at a vertex [1/m²].
using SecondDerivatives = std::array<Combination, 3>;

Combination combine(const SecondDerivatives& derivatives, const Vec3& factors) {
  Combination sum;
  for (int k = 0; k < 3; ++k) {
    for (const auto& [vertex, weight] : derivatives[k]) sum[vertex] += factors[k] * weight;
  }
  return sum;
}

/// Splits an energy ½ kᵀ form k of the three into independent rows: form = Σ_c d_c l_c l_cᵀ (square-root-free
/// Cholesky). The form includes the area [N·m³].
void add_form(BendingRows& rows, const SecondDerivatives& derivatives, const Mat3& form) {
  Mat3 rest = form;
  for (int c = 0; c < 3; ++c) {
    const double pivot = rest(c, c);
    if (pivot <= 1e-14 * form.diagonal().maxCoeff()) continue;
    const Vec3 l = rest.col(c) / pivot;
    rest -= pivot * l * l.transpose();
    for (const auto& [vertex, weight] : combine(derivatives, l)) {
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
    return v[(corner_of(v, center) + steps) % 3];
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

double angle_between(const Vec3& a, const Vec3& b) { return find_angle(a.cross(b).norm(), a.dot(b)); }

FlatRing lay_flat(const RestMesh& mesh, int center, const Ring& ring) {
  FlatRing flat;
  const std::size_t n = ring.vertices.size();
  // To a vertex of the ring, in triangle t of it.
  const auto spoke = [&](std::size_t t, std::size_t k) {
    return mesh.between(ring.triangles[t], center, ring.vertices[k % n]);
  };
  double total = 0;
  Vec3 normal = Vec3::Zero();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 first = spoke(k, k), second = spoke(k, k + 1);
    flat.angle.push_back(total);
    flat.length.push_back(0.5 * (first.norm() + spoke((k + n - 1) % n, k).norm()));
    total += angle_between(first, second);
    normal += first.cross(second);
  }
  flat.scale = 2 * kPi / total;
  for (double& a : flat.angle) a *= flat.scale;
  const Vec3 axis = spoke(0, 0);
  flat.axis = (axis - axis.dot(normal) * normal / normal.squaredNorm()).normalized();
  flat.across = normal.normalized().cross(flat.axis);
  return flat;
}

/// The warp's angle in the flat ring: mean over its triangles, by area, of undirected axes.
double warp_angle(const RestMesh& mesh, int center, const Ring& ring, const FlatRing& flat,
                  const WarpField& warp) {
  double c = 0, s = 0;
  for (std::size_t k = 0; k < ring.triangles.size(); ++k) {
    const int t = ring.triangles[k];
    const TriangleCorners p = mesh.corners(t);
    const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
    const Vec3 spoke = mesh.between(t, center, ring.vertices[k]).normalized();
    const double cosine = spoke.dot(warp.warp[t]);
    const double sine = normal.normalized().dot(spoke.cross(warp.warp[t]));
    const SinCos doubled = sin_cos(2 * (flat.angle[k] + find_angle(sine, cosine)));
    c += normal.norm() * doubled.cos;
    s += normal.norm() * doubled.sin;
  }
  return 0.5 * find_angle(s, c);
}

/// −Σ_j (∫ ∂a φ_i ∂b φ_j) x_j / A_i over the flat ring, with warp as the first axis; A_i in `area`.
SecondDerivatives second_derivatives(int center, const Ring& ring, const FlatRing& flat, double warp_at,
                                     double& area) {
  const std::size_t n = ring.vertices.size();
  std::vector<Vec2> place;
  for (std::size_t k = 0; k < n; ++k) {
    const SinCos at = sin_cos(flat.angle[k] - warp_at);
    place.push_back(flat.length[k] * Vec2(at.cos, at.sin));
  }
  SecondDerivatives derivative;
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

std::vector<BorderVertex> find_border(const RestMesh& mesh, const std::vector<Ring>& rings) {
  std::vector<Vec3> first(mesh.positions.size(), Vec3::Zero()), last = first;
  std::vector<int> num_inner(mesh.positions.size(), 0);
  for (const Edge& e : build_edges(mesh)) {
    const bool inner_a = !rings[e.a].triangles.empty(), inner_b = !rings[e.b].triangles.empty();
    num_inner[e.a] += inner_b;
    num_inner[e.b] += inner_a;
    if (e.num_triangles != 1) continue;
    const Vec3 along = mesh.between(e.triangles[0], e.a, e.b).normalized();
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

/// Curvatures at an inner vertex: of its own area, and along the border at vertices next to it.
struct VertexCurvature {
  struct AlongBorder {
    double cosine, sine;  // of the border to warp
    double area;          // [m²]
    Vec3 factors() const { return {cosine * cosine, sine * sine, 2 * cosine * sine}; }  // of the derivatives
  };

  SecondDerivatives derivatives;
  double area = 0;  // [m²]
  std::vector<AlongBorder> borders;
};

VertexCurvature find_curvature(const RestMesh& mesh, int center, const Ring& ring, const WarpField& warp,
                               const std::vector<BorderVertex>& border) {
  const FlatRing flat = lay_flat(mesh, center, ring);
  const double warp_at = warp_angle(mesh, center, ring, flat, warp);
  VertexCurvature curvature;
  curvature.derivatives = second_derivatives(center, ring, flat, warp_at, curvature.area);
  for (const int v : ring.vertices) {
    if (border[v].area == 0) continue;
    const double along = find_angle(border[v].tangent.dot(flat.across), border[v].tangent.dot(flat.axis));
    const SinCos at = sin_cos(along - warp_at);
    curvature.borders.push_back({at.cos, at.sin, border[v].area});
  }
  return curvature;
}

void add_stencil(BendingRows& rows, const VertexCurvature& curvature, const Fabric& fabric) {
  Mat3 form = Mat3::Zero();
  form.diagonal() =
      (1 - kHingeShare) * curvature.area * Vec3(fabric.bend_warp, fabric.bend_weft, twist_rigidity(fabric));
  for (const VertexCurvature::AlongBorder& b : curvature.borders) {
    const Vec3 along = b.factors();
    form +=
        (1 - kHingeShare) * b.area * bending_rigidity(fabric, b.cosine, b.sine) * along * along.transpose();
  }
  add_form(rows, curvature.derivatives, form);
}

/// The angle of a hinge of flat triangles.
struct LinearHinge {
  std::array<double, 4> weight;  // of its vertices [1/m]
  double length = 0;             // of its edge [m]
  double area = 0;               // of its triangles [m²]
};

LinearHinge linearise(const HingeElement& hinge, const RestMesh& mesh) {
  LinearHinge linear{.weight = {0, 0, 0, 0}};
  const auto& [a, b, p, q] = hinge.vertices;
  for (const int side : {2, 3}) {
    const int t = hinge.triangles[side - 2];
    const Vec3 edge = mesh.between(t, a, b), tip = mesh.between(t, a, hinge.vertices[side]);
    linear.length += 0.5 * edge.norm();
    const double along = tip.dot(edge) / edge.squaredNorm();
    const double height = (tip - along * edge).norm();
    linear.weight[side] = 1 / height;
    linear.weight[0] -= (1 - along) * linear.weight[side];
    linear.weight[1] -= along * linear.weight[side];
    linear.area += 0.5 * edge.norm() * height;
  }
  return linear;
}

/// Whether stencils reach each vertex (num_vertices).
std::vector<char> find_reached(const std::vector<Ring>& rings) {
  std::vector<char> is_reached(rings.size(), 0);
  for (std::size_t v = 0; v < rings.size(); ++v) {
    if (rings[v].triangles.empty()) continue;
    is_reached[v] = 1;
    for (const int other : rings[v].vertices) is_reached[other] = 1;
  }
  return is_reached;
}

/// Hinges of full rigidity: no stencil reaches a vertex next to the edge.
bool is_full(const HingeElement& hinge, const std::vector<char>& is_reached) {
  return !is_reached[hinge.vertices[2]] || !is_reached[hinge.vertices[3]];
}

/// Hinges, linearised at rest: with full rigidity if no stencil reaches a vertex next to the edge, else with
/// a small share, so that small or narrow meshes have no bending mode of zero energy.
void add_hinges(BendingRows& rows, const RestMesh& mesh, const WarpField& warp, const Fabric& fabric,
                const std::vector<char>& is_reached) {
  for (const HingeElement& hinge : build_hinges(mesh, warp, fabric)) {
    const double share = is_full(hinge, is_reached) ? 1.0 : kHingeShare;
    const auto& [weight, length, area] = linearise(hinge, mesh);
    const auto& [a, b, p, q] = hinge.vertices;
    // A row is the angle per edge length, like a curvature; the stiffness compensates.
    add_row(
        rows, share * hinge.stiffness * length * length,
        {{a, weight[0] / length}, {b, weight[1] / length}, {p, weight[2] / length}, {q, weight[3] / length}});
  }
}

/// Second derivative along an axis of a grid.
struct ThreadStencil {
  bool is_along_x;
  double area;                                    // [m²]
  std::array<std::pair<int, double>, 3> entries;  // particles with weights [1/m²]
};

/// Calls visit(stencil) for those around a particle: none at the ends of a thread; along a border of half the area.
template <class Visit>
void visit_thread_stencils(const Grid& grid, int i, int j, const Visit& visit) {
  const double dx = grid.spacing_x(), dz = grid.spacing_z(), area = dx * dz;
  const double wx = 1 / (dx * dx), wz = 1 / (dz * dz);
  const double share_z = j == 0 || j == grid.cells_z ? 0.5 : 1.0;
  const double share_x = i == 0 || i == grid.cells_x ? 0.5 : 1.0;
  const int at = grid.index(i, j);
  if (i > 0 && i < grid.cells_x)
    visit(ThreadStencil{
        true, area * share_z, {{{grid.index(i - 1, j), wx}, {at, -2 * wx}, {grid.index(i + 1, j), wx}}}});
  if (j > 0 && j < grid.cells_z)
    visit(ThreadStencil{
        false, area * share_x, {{{grid.index(i, j - 1), wz}, {at, -2 * wz}, {grid.index(i, j + 1), wz}}}});
}

std::vector<Ring> find_rings(const RestMesh& mesh) {
  const Neighbourhood neighbourhood(mesh);
  std::vector<Ring> rings;
  for (int v = 0; v < mesh.num_vertices(); ++v) rings.push_back(neighbourhood.ring(v));
  return rings;
}

/// A fabric whose bending rigidities are the moments of friction; at an angle ψ from warp c² times that of warp
/// threads and s² times that of weft threads [N].
Fabric friction_as_rigidity(const Fabric& f) {
  Fabric friction;
  friction.bend_warp = 0.5 * f.bend_hysteresis_warp;
  friction.bend_weft = 0.5 * f.bend_hysteresis_weft;
  friction.bend_bias = 0.5 * (friction.bend_warp + friction.bend_weft);
  return friction;
}

template <class Weights>
void add_thread_row(ThreadBends& rows, int center, double friction, double stiffness,
                    const Weights& weights) {
  for (const auto& [vertex, weight] : weights) {
    rows.vertex.push_back(vertex);
    rows.weight.push_back(weight);
  }
  rows.begin.push_back(static_cast<int>(rows.vertex.size()));
  rows.center.push_back(center);
  rows.friction.push_back(friction);
  rows.stiffness.push_back(stiffness);
}

void add_thread_hinges(ThreadBends& rows, const RestMesh& mesh, const WarpField& warp, const Fabric& fabric,
                       const std::vector<char>& is_reached) {
  const std::vector<HingeElement> elastic = build_hinges(mesh, warp, fabric);
  const std::vector<HingeElement> friction = build_hinges(mesh, warp, friction_as_rigidity(fabric));
  for (std::size_t h = 0; h < elastic.size(); ++h) {
    if (!is_full(elastic[h], is_reached)) continue;
    const auto& [weight, length, area] = linearise(elastic[h], mesh);
    // A hinge's curvature is the angle times length over area, its stiffness rigidity times length² over area.
    const double per_area = area / length;
    Combination row;
    for (int c = 0; c < 4; ++c) row[elastic[h].vertices[c]] = weight[c] / per_area;
    const double square = per_area * per_area;
    add_thread_row(rows, elastic[h].vertices[0], friction[h].stiffness * square,
                   elastic[h].stiffness * square, row);
  }
}

}  // namespace

BendingRows build_grid_bending(const Grid& grid, GridWarp warp, const Fabric& fabric) {
  BendingRows rows;
  const bool is_first = warp == GridWarp::first_axis;
  const double along_x = is_first ? fabric.bend_warp : fabric.bend_weft;
  const double along_z = is_first ? fabric.bend_weft : fabric.bend_warp;
  const double area = grid.spacing_x() * grid.spacing_z(), wt = 1 / area;
  for (int j = 0; j < grid.num_rows(); ++j) {
    for (int i = 0; i < grid.num_columns(); ++i) {
      visit_thread_stencils(grid, i, j, [&](const ThreadStencil& stencil) {
        add_row(rows, (stencil.is_along_x ? along_x : along_z) * stencil.area,
                {stencil.entries[0], stencil.entries[1], stencil.entries[2]});
      });
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

BendingRows build_mesh_bending(const RestMesh& mesh, const WarpField& warp, const Fabric& fabric) {
  const std::vector<Ring> rings = find_rings(mesh);
  const std::vector<BorderVertex> border = find_border(mesh, rings);
  BendingRows rows;
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (rings[v].triangles.empty()) continue;
    add_stencil(rows, find_curvature(mesh, v, rings[v], warp, border), fabric);
  }
  add_hinges(rows, mesh, warp, fabric, find_reached(rings));
  return rows;
}

bool has_bending_memory(const Fabric& f) {
  return f.bend_hysteresis_warp > 0 || f.bend_hysteresis_weft > 0 || f.bend_set > 0;
}

ThreadBends build_grid_thread_bends(const Grid& grid, GridWarp warp, const Fabric& fabric) {
  ThreadBends rows{.set = fabric.bend_set};
  if (!has_bending_memory(fabric)) return rows;
  const bool is_first = warp == GridWarp::first_axis;
  const Fabric friction = friction_as_rigidity(fabric);
  for (int j = 0; j < grid.num_rows(); ++j) {
    for (int i = 0; i < grid.num_columns(); ++i) {
      visit_thread_stencils(grid, i, j, [&](const ThreadStencil& stencil) {
        const bool is_warp = stencil.is_along_x == is_first;
        add_thread_row(rows, grid.index(i, j),
                       stencil.area * (is_warp ? friction.bend_warp : friction.bend_weft),
                       stencil.area * (is_warp ? fabric.bend_warp : fabric.bend_weft), stencil.entries);
      });
    }
  }
  return rows;
}

ThreadBends build_mesh_thread_bends(const RestMesh& mesh, const WarpField& warp, const Fabric& fabric) {
  ThreadBends rows{.set = fabric.bend_set};
  if (!has_bending_memory(fabric)) return rows;
  const Fabric friction = friction_as_rigidity(fabric);
  const std::vector<Ring> rings = find_rings(mesh);
  const std::vector<BorderVertex> border = find_border(mesh, rings);
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (rings[v].triangles.empty()) continue;
    const VertexCurvature c = find_curvature(mesh, v, rings[v], warp, border);
    add_thread_row(rows, v, friction.bend_warp * c.area, fabric.bend_warp * c.area, c.derivatives[0]);
    add_thread_row(rows, v, friction.bend_weft * c.area, fabric.bend_weft * c.area, c.derivatives[1]);
    for (const VertexCurvature::AlongBorder& b : c.borders)
      add_thread_row(rows, v, bending_rigidity(friction, b.cosine, b.sine) * b.area,
                     bending_rigidity(fabric, b.cosine, b.sine) * b.area,
                     combine(c.derivatives, b.factors()));
  }
  add_thread_hinges(rows, mesh, warp, fabric, find_reached(rings));
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
