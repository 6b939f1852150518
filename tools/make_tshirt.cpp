// Sews the T-shirts of the garment scenes: make_tshirt tshirt.obj, make_tshirt tshirt_fine.obj 1.43
//
// The pattern is half of a panel in the plane x >= 0, made of two patches of quads:
//
//            N___
//      neck /    ‾‾‾S___               N neck point, S shoulder tip, U underarm,
//     ____./        |    ‾‾‾‾‾___C     C and D ends of the cuff, H hem corner
//    |               )          /
//    |     torso    |   sleeve /
//    |              U---------D
//    |              |
//    |______hem_____H
//    x = 0
//
// 1. Each patch interpolates between its four sides (a Coons patch). The sides are divided into pieces of
//    equal length; torso and sleeve share the points of the armhole S–U.
// 2. Quads are cut along the shorter diagonal, alternately where both are about equal.
// 3. The half is mirrored and welded at x = 0: a flat panel.
// 4. The panel is inflated like a pillow that is held along the seams. With u from the Poisson equation
//    -Δu = 1, u = 0 on the seams, the height is sqrt(u), scaled; across a strip that is an ellipse. The open
//    edges (neck, hem, cuffs) are free.
// 5. The vertices are moved within the plane until the inflated edges have about equal lengths. After each
//    move the panel is inflated again.
//
// Front and back differ in the depth of the neck and in the side to which they bulge. Their vertices on the
// seams (N–S–C, U–D, U–H) have equal coordinates but are separate: welding sews them.

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <set>
#include <utility>

#include "weft/core/angle.h"
#include "weft/io/obj_reader.h"
#include "weft/mesh/clean.h"

namespace weft::engine {
namespace {

using Curve = std::vector<Vec3>;  // a polyline in the plane z = 0

// The pattern [m]
const Vec3 kHemCorner{0.265, 0.85, 0};
const Vec3 kUnderarm{0.268, 1.205, 0};
const Vec3 kShoulderTip{0.212, 1.415, 0};
const Vec3 kNeckPoint{0.085, 1.455, 0};
constexpr double kFrontNeckDepth = 0.095;
constexpr double kBackNeckDepth = 0.03;
constexpr double kSleeveLength = 0.22;
constexpr double kCuffWidth = 0.165;
constexpr double kSleeveSlope_deg = 15;  // below the horizontal
constexpr double kChestHeight = 0.1;     // of the bulge

/// Numbers of quads along the sides.
struct Cells {
  int shoulder, neck, side, armhole, sleeve;  // neck: of the half

  int hem() const { return neck + shoulder; }
};

/// For edges of about 0.02 m, slightly longer after inflation, divided by `fineness`.
Cells make_cells(double fineness) {
  const auto times = [fineness](int cells) { return static_cast<int>(std::lround(fineness * cells)); };
  return {
      .shoulder = times(7), .neck = times(7), .side = times(18), .armhole = times(11), .sleeve = times(10)};
}

constexpr int kRelaxations = 60;  // further ones change angles by less than a degree

/// Rounds to whole micrometres: the file is short, and equal points are equal in every bit (adding 0 turns -0
/// into 0).
Vec3 rounded(const Vec3& x) { return (x * 1e6).array().round() / 1e6 + 0.0; }

/// The quadratic Bézier curve from a to c that starts and ends towards b.
Curve make_arc(const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr int kPieces = 200;
  Curve curve;
  for (int k = 0; k <= kPieces; ++k) {
    const double t = static_cast<double>(k) / kPieces;
    curve.push_back((1 - t) * (1 - t) * a + 2 * t * (1 - t) * b + t * t * c);
  }
  return curve;
}

/// The curve as `pieces` edges of equal length along it.
Curve divide(const Curve& curve, int pieces) {
  std::vector<double> along = {0};
  for (size_t k = 1; k < curve.size(); ++k) along.push_back(along.back() + (curve[k] - curve[k - 1]).norm());
  Curve result;
  size_t k = 1;
  for (int i = 0; i <= pieces; ++i) {
    const double wanted = along.back() * i / pieces;
    while (k + 1 < curve.size() && along[k] < wanted) ++k;
    const double t = std::min((wanted - along[k - 1]) / (along[k] - along[k - 1]), 1.0);
    result.push_back(rounded(curve[k - 1] + t * (curve[k] - curve[k - 1])));
  }
  return result;
}

Curve divide(const Vec3& a, const Vec3& b, int pieces) { return divide(Curve{a, b}, pieces); }

/// `first` and then `second`, which begins where `first` ends.
Curve join(Curve first, const Curve& second) {
  first.insert(first.end(), second.begin() + 1, second.end());
  return first;
}

// ---- Patches ----

/// Whether to cut the quad a b c d along a–c, not along b–d.
bool cut_first_diagonal(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, bool if_alike) {
  constexpr double kAlike = 1.15;
  const double ac = (c - a).norm(), bd = (d - b).norm();
  if (std::max(ac, bd) < kAlike * std::min(ac, bd)) return if_alike;
  return ac < bd;
}

/// A patch between four sides: bottom and top point right, left and right point up, and corners coincide.
TriangleMesh make_patch(const Curve& bottom, const Curve& top, const Curve& left, const Curve& right) {
  const int columns = static_cast<int>(bottom.size()), rows = static_cast<int>(left.size());
  TriangleMesh patch;
  for (int j = 0; j < rows; ++j) {
    const double v = static_cast<double>(j) / (rows - 1);
    for (int i = 0; i < columns; ++i) {
      const double u = static_cast<double>(i) / (columns - 1);
      const Vec3 bilinear = (1 - v) * ((1 - u) * bottom.front() + u * bottom.back()) +
                            v * ((1 - u) * top.front() + u * top.back());
      patch.positions.push_back(
          rounded((1 - v) * bottom[i] + v * top[i] + (1 - u) * left[j] + u * right[j] - bilinear));
    }
  }
  for (int j = 0; j + 1 < rows; ++j) {
    for (int i = 0; i + 1 < columns; ++i) {
      const int a = j * columns + i, b = a + 1, d = a + columns, c = d + 1;
      const auto& x = patch.positions;
      if (cut_first_diagonal(x[a], x[b], x[c], x[d], (i + j) % 2 == 0)) {
        patch.triangles.insert(patch.triangles.end(), {{a, b, c}, {a, c, d}});
      } else {
        patch.triangles.insert(patch.triangles.end(), {{a, b, d}, {b, c, d}});
      }
    }
  }
  return patch;
}

void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const int first = mesh.num_vertices();
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
}

void turn_over(TriangleMesh& mesh) {
  for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

TriangleMesh mirrored(TriangleMesh mesh) {
  for (Vec3& x : mesh.positions) x.x() = -x.x();
  turn_over(mesh);
  return mesh;
}

// ---- The pattern ----

/// The sides of half a panel.
struct Pattern {
  Curve hem, centre, neck, shoulder, side, armhole, sleeve_top, cuff, sleeve_bottom;
};

Pattern make_pattern(double neck_depth, const Cells& cells) {
  const auto [sin, cos] = sin_cos_deg(kSleeveSlope_deg);
  const Vec3 cuff_top = kShoulderTip + kSleeveLength * Vec3(cos, -sin, 0);
  const Vec3 cuff_bottom = cuff_top + kCuffWidth * Vec3(-sin, -cos, 0);
  const Vec3 hem_centre(0, kHemCorner.y(), 0);
  const Vec3 neck_centre(0, kNeckPoint.y() - neck_depth, 0);
  const Vec3 neck_bend(0.75 * kNeckPoint.x(), neck_centre.y(), 0);
  const Vec3 armhole_bend(kShoulderTip.x() + 0.005, kUnderarm.y() + 0.06, 0);

  Pattern p;
  p.hem = divide(hem_centre, kHemCorner, cells.hem());
  p.centre = divide(hem_centre, neck_centre, cells.side + cells.armhole);
  p.neck = divide(make_arc(neck_centre, neck_bend, kNeckPoint), cells.neck);
  p.shoulder = divide(kNeckPoint, kShoulderTip, cells.shoulder);
  p.side = divide(kHemCorner, kUnderarm, cells.side);
  p.armhole = divide(make_arc(kUnderarm, armhole_bend, kShoulderTip), cells.armhole);
  p.sleeve_top = divide(kShoulderTip, cuff_top, cells.sleeve);
  p.sleeve_bottom = divide(kUnderarm, cuff_bottom, cells.sleeve);
  p.cuff = divide(cuff_bottom, cuff_top, cells.armhole);
  return p;
}

TriangleMesh make_flat_panel(const Pattern& p) {
  TriangleMesh half = make_patch(p.hem, join(p.neck, p.shoulder), p.centre, join(p.side, p.armhole));
  append(half, make_patch(p.sleeve_bottom, p.sleeve_top, p.armhole, p.cuff));
  TriangleMesh panel = half;
  append(panel, mirrored(half));
  return clean_mesh(panel, {.weld_distance = 0}).mesh;
}

/// (num_vertices) true for the vertices on one of the curves or its mirror image.
std::vector<bool> find_points(const TriangleMesh& panel, const std::vector<Curve>& curves) {
  std::set<std::pair<double, double>> points;
  for (const Curve& curve : curves) {
    for (const Vec3& x : curve) points.insert({x.x(), x.y()});
  }
  std::vector<bool> found;
  for (const Vec3& x : panel.positions) found.push_back(points.contains({std::abs(x.x()), x.y()}));
  return found;
}

// ---- Inflation ----

/// Solves -Δu = 1, u = 0 where held, with linear finite elements (cotangent weights: half the cotangent of
/// the angle opposite to an edge, per triangle).
Eigen::VectorXd solve_poisson(const TriangleMesh& mesh, const std::vector<bool>& held) {
  const int n = mesh.num_vertices();
  const auto& x = mesh.positions;
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int row, int column, double value) {
    if (!held[row] && !held[column]) entries.emplace_back(row, column, value);
  };
  for (const Triangle& triangle : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const int a = triangle[k], b = triangle[(k + 1) % 3], c = triangle[(k + 2) % 3];
      const Vec3 ca = x[a] - x[c], cb = x[b] - x[c];
      const double weight = 0.5 * ca.dot(cb) / ca.cross(cb).norm();
      add(a, a, weight);
      add(b, b, weight);
      add(a, b, -weight);
      add(b, a, -weight);
    }
  }
  const auto areas = compute_vertex_areas(mesh);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(n);
  for (int v = 0; v < n; ++v) {
    if (held[v]) {
      entries.emplace_back(v, v, 1.0);
    } else {
      load[v] = areas[v];
    }
  }
  Eigen::SparseMatrix<double> stiffness(n, n);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(stiffness).solve(load);
}

void inflate(TriangleMesh& panel, const std::vector<bool>& on_seam) {
  const Eigen::VectorXd u = solve_poisson(panel, on_seam);
  const double highest = u.maxCoeff();
  for (int v = 0; v < panel.num_vertices(); ++v) {
    panel.positions[v].z() = kChestHeight * std::sqrt(std::max(u[v], 0.0) / highest);
  }
}

void flatten(TriangleMesh& panel) {
  for (Vec3& x : panel.positions) x.z() = 0;
}

/// One relaxation of springs in the plane, with forces from the lengths of the inflated edges; in equilibrium
/// these are equal. Vertices of open edges slide along them; held vertices stay.
void relax_once(TriangleMesh& panel, const std::vector<bool>& held) {
  const auto edges = build_edges(panel);
  std::vector<bool> on_border(held.size(), false);
  for (const Edge& edge : edges) {
    if (edge.num_triangles == 1) on_border[edge.a] = on_border[edge.b] = true;
  }
  std::vector<Vec3> sums(held.size(), Vec3::Zero());
  std::vector<double> weights(held.size(), 0.0);
  const auto pull = [&](int v, int neighbour, double weight) {
    sums[v] += weight * panel.positions[neighbour];
    weights[v] += weight;
  };
  for (const Edge& edge : edges) {
    const Vec3 along = panel.positions[edge.a] - panel.positions[edge.b];
    const double stretch = along.norm() / along.head<2>().norm();
    const bool is_border = edge.num_triangles == 1;
    if (is_border || !on_border[edge.a]) pull(edge.a, edge.b, stretch);
    if (is_border || !on_border[edge.b]) pull(edge.b, edge.a, stretch);
  }
  constexpr double kDamping = 0.5;
  for (size_t v = 0; v < held.size(); ++v) {
    if (!held[v]) panel.positions[v] += kDamping * (sums[v] / weights[v] - panel.positions[v]);
  }
}

TriangleMesh make_front(double neck_depth, const Cells& cells) {
  const Pattern pattern = make_pattern(neck_depth, cells);
  TriangleMesh panel = make_flat_panel(pattern);
  const auto on_seam =
      find_points(panel, {pattern.side, pattern.sleeve_bottom, pattern.sleeve_top, pattern.shoulder});
  const auto on_neck = find_points(panel, {pattern.neck});
  auto held = on_seam;
  for (size_t v = 0; v < held.size(); ++v) held[v] = on_seam[v] || on_neck[v];
  for (int round = 0; round < kRelaxations; ++round) {
    inflate(panel, on_seam);
    relax_once(panel, held);
    flatten(panel);
  }
  inflate(panel, on_seam);
  for (Vec3& x : panel.positions) x = rounded(x);
  return panel;
}

TriangleMesh make_back(double neck_depth, const Cells& cells) {
  TriangleMesh panel = make_front(neck_depth, cells);
  for (Vec3& x : panel.positions) x.z() = 0.0 - x.z();  // unlike -z, gives no negative zero
  turn_over(panel);
  return panel;
}

// ---- The report ----

struct Quality {
  double min_angle_deg = 180;
  double shortest = 1, longest = 0, mean = 0;  // edges [m]
};

Quality measure(const TriangleMesh& mesh) {
  Quality quality;
  const auto edges = build_edges(mesh);
  for (const Edge& edge : edges) {
    const double length = (mesh.positions[edge.a] - mesh.positions[edge.b]).norm();
    quality.shortest = std::min(quality.shortest, length);
    quality.longest = std::max(quality.longest, length);
    quality.mean += length / static_cast<double>(edges.size());
  }
  for (const Triangle& triangle : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Vec3& x = mesh.positions[triangle[k]];
      const Vec3 e = mesh.positions[triangle[(k + 1) % 3]] - x, f = mesh.positions[triangle[(k + 2) % 3]] - x;
      // For printing only, so the C library's angle is sufficient.
      const double angle = std::atan2(e.cross(f).norm(), e.dot(f)) * 57.29577951308232;
      quality.min_angle_deg = std::min(quality.min_angle_deg, angle);
    }
  }
  return quality;
}

void make_tshirt(const char* file, double fineness) {
  const Cells cells = make_cells(fineness);
  const std::vector<ObjObject> panels = {{"front", make_front(kFrontNeckDepth, cells)},
                                         {"back", make_back(kBackNeckDepth, cells)}};
  write_obj(file, panels);
  for (const auto& [name, mesh] : panels) {
    const Quality q = measure(mesh);
    std::printf(
        "%s: %d vertices, %d triangles, angles from %.1f deg, edges from %.4f to %.4f m, mean %.4f m\n",
        name.c_str(), mesh.num_vertices(), mesh.num_triangles(), q.min_angle_deg, q.shortest, q.longest,
        q.mean);
  }
}

}  // namespace
}  // namespace weft::engine

int main(int argc, char** argv) {
  const double fineness = argc == 3 ? std::atof(argv[2]) : 1;
  if (argc < 2 || argc > 3 || !(fineness >= 0.5 && fineness <= 10)) {
    std::fprintf(stderr, "usage: make_tshirt OUT.obj [FINENESS from 0.5 to 10]\n");
    return 2;
  }
  try {
    weft::engine::make_tshirt(argv[1], fineness);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_tshirt: %s\n", error.what());
    return 1;
  }
  return 0;
}
