#include "tools/wardrobe/garments.h"

#include <algorithm>
#include <cmath>

#include "weft/core/angle.h"
#include "weft/mesh/clean.h"
#include "weft/mesh/grid.h"

namespace weft::engine::wardrobe {
namespace {

constexpr double kPi = 3.141592653589793;
constexpr double kSnap = 0.25;  // of a cell

const std::vector<Bone> kTop = {kHips, kChest, kLeftArm, kLeftForearm, kRightArm, kRightForearm};
const std::vector<Bone> kBottom = {kHips, kLeftThigh, kLeftShin, kRightThigh, kRightShin};
const Eigen::AlignedBox3d kRoom(Vec3(-0.9, 0, -0.4), Vec3(0.9, 1.7, 0.4));

Field offset(const Field& field, double by) {
  return [field, by](const Vec3& p) { return field(p) - by; };
}

Field unite(const Field& a, const Field& b) {
  return [a, b](const Vec3& p) { return std::min(a(p), b(p)); };
}

/// Around the legs, from waist to below the knees; the cross-section is an ellipse.
Field skirt_field() {
  return [](const Vec3& p) {
    const double t = std::clamp((1.02 - p.y()) / 0.7, -0.2, 1.2);
    return std::hypot(p.x(), 1.25 * p.z()) - (0.165 + 0.10 * t);
  };
}

/// The skirt with the hips in it.
Field worn_skirt_field() { return unite(offset(body_field({kHips}, 0.06), 0.009), skirt_field()); }

std::vector<HalfSpace> join(std::vector<HalfSpace> first, const std::vector<HalfSpace>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

TriangleMesh cut(TriangleMesh mesh, const std::vector<HalfSpace>& kept, double snap) {
  for (const HalfSpace& half : kept) mesh = clip(mesh, half, snap);
  return mesh;
}

HalfSpace below(double y) { return {Vec3::UnitY(), y}; }
HalfSpace above(double y) { return {-Vec3::UnitY(), -y}; }

/// Ends of both sleeves, at ±x.
std::vector<HalfSpace> cuffs(double x) { return {{Vec3::UnitX(), x}, {-Vec3::UnitX(), x}}; }

HalfSpace neckline() {
  const Vec3 normal = Vec3(0, 1, 0.35).normalized();
  return {normal, normal.dot(Vec3(0, 1.492, 0))};
}

/// A field with arms lifted by an angle.
Field lift_arms(const Field& field, double angle_deg) {
  return [field, angle_deg](const Vec3& p) {
    const double share =
        std::clamp((std::abs(p.x()) - 0.13) / 0.12, 0.0, 1.0) * std::clamp((p.y() - 1.08) / 0.12, 0.0, 1.0);
    const auto [sin, cos] = sin_cos_deg(share * angle_deg);
    const Vec3 shoulder = joint_of(kLeftArm);
    const double x = std::abs(p.x()) - shoulder.x(), y = p.y() - shoulder.y();
    return field({shoulder.x() + cos * x + sin * y, shoulder.y() - sin * x + cos * y, p.z()});
  };
}

TriangleMesh wall(const Field& field, double cell, const std::vector<HalfSpace>& kept, double snap = kSnap) {
  return cut(build_isosurface(field, kRoom, cell), kept, snap * cell);
}

/// The part of a mesh between two half planes through the y axis, at angles `from` and `to` from x to z.
TriangleMesh sector(const TriangleMesh& mesh, double from_deg, double to_deg, double snap) {
  const auto [sin_a, cos_a] = sin_cos_deg(from_deg);
  const auto [sin_b, cos_b] = sin_cos_deg(to_deg);
  return cut(mesh, {{Vec3(sin_a, 0, -cos_a), 0}, {Vec3(-sin_b, 0, cos_b), 0}}, snap);
}

/// A sheet in rows from top to bottom; `place` of (0 to 1 across, 0 to 1 down).
template <class Place>
TriangleMesh weave(int num_across, int num_down, const Place& place) {
  TriangleMesh mesh;
  for (int j = 0; j <= num_down; ++j) {
    for (int i = 0; i <= num_across; ++i)
      mesh.positions.push_back(place(static_cast<double>(i) / num_across, static_cast<double>(j) / num_down));
  }
  for (int j = 0; j < num_down; ++j) {
    for (int i = 0; i < num_across; ++i) {
      const int a = j * (num_across + 1) + i, b = a + 1, c = a + num_across + 1, d = c + 1;
      if ((i + j) % 2 == 0) {
        mesh.triangles.insert(mesh.triangles.end(), {{a, d, b}, {a, c, d}});
      } else {
        mesh.triangles.insert(mesh.triangles.end(), {{a, c, b}, {b, c, d}});
      }
    }
  }
  return mesh;
}

constexpr double kWaist = 1.08;  // height of the dress's waist [m]

Field bodice_field() { return offset(body_field({kHips, kChest}, 0.06), 0.009); }

/// Distance of the bodice from the y axis at the waist [m].
double waist_radius(const Field& bodice, double angle) {
  double low = 0, high = 0.4;
  while (high - low > 1e-7) {
    const double middle = 0.5 * (low + high);
    (bodice({middle * std::cos(angle), kWaist, middle * std::sin(angle)}) < 0 ? low : high) = middle;
  }
  return low;
}

/// A sixth of the skirt, with S-shaped folds that open towards the hem:
///
///     (x, z) = (L t/2π + b sin 2t, a cos t)     for folds of length L; for b > L/4π they overhang
TriangleMesh make_pleats(double cell, int sixth) {
  constexpr int kPleats = 4;
  const Field bodice = bodice_field();
  const auto place = [&](double across, double down) {
    const double t = 2 * kPi * kPleats * across, swell = std::min(1.0, 2.5 * down);
    const double overhang = swell * 0.16 * kPi / 3 / kPleats;
    const double angle = kPi / 3 * (sixth + across) + overhang * std::sin(2 * t);
    const double radius =
        waist_radius(bodice, angle) + 0.15 * std::pow(down, 0.7) + 0.010 * swell * std::cos(t);
    return Vec3(radius * std::cos(angle), kWaist - 0.5 * down, radius * std::sin(angle));
  };
  return weave(static_cast<int>(0.42 / cell), static_cast<int>(0.52 / cell), place);
}

// The dress's panels, in the plane: x across, y up [m].
constexpr double kNeck = 0.085, kShoulder = 0.185;  // half widths
constexpr double kNeckHeight = 1.60, kShoulderHeight = 1.555, kHem = 0.72;
constexpr double kArmhole = 0.23;  // height of the armholes

/// Half the width of a panel, below the shoulder by `depth`.
double panel_width(double depth) {
  const double u = depth / kArmhole;
  if (u < 1) return kShoulder - 0.03 * std::sin(kPi * u) * (1 - u) + 0.045 * u * u;
  return 0.23 + 0.12 * std::pow((depth - kArmhole) / (kShoulderHeight - kHem - kArmhole), 1.2);
}

/// The point of a panel at (0 to 1 across, 0 to 1 down).
Eigen::Vector2d panel_point(double across, double down, double neckline) {
  const double x = (2 * across - 1) * kShoulder, beside = std::abs(x) / kNeck;
  const double top = beside < 1 ? kNeckHeight - neckline * (1 - beside * beside)
                                : kNeckHeight + (kShoulderHeight - kNeckHeight) * (std::abs(x) - kNeck) /
                                                    (kShoulder - kNeck);
  return {(2 * across - 1) * panel_width(down * (kShoulderHeight - kHem)), top + (kHem - top) * down};
}

}  // namespace

Pattern make_dress_pattern(double cell) {
  const int columns = 2 * static_cast<int>(0.275 / cell), rows = static_cast<int>(0.86 / cell);
  const int neck = static_cast<int>(columns * (kShoulder - kNeck) / (2 * kShoulder));
  const int armhole = static_cast<int>(rows * kArmhole / (kShoulderHeight - kHem));
  Pattern pattern;
  for (const int side : {1, -1}) {
    const auto place = [&](double across, double down) {
      const Eigen::Vector2d p = panel_point(across, down, side > 0 ? 0.09 : 0.03);
      return Vec3(p.x(), p.y(), 0.01 + 0.17 * side);
    };
    TriangleMesh panel = weave(columns, rows, place);
    if (side < 0) {
      for (Triangle& t : panel.triangles) std::swap(t[1], t[2]);
    }
    for (const Triangle& t : panel.triangles) {
      CornerUv& uv = pattern.uv.emplace_back();
      for (int c = 0; c < 3; ++c) uv[c] = {panel.positions[t[c]].y(), -side * panel.positions[t[c]].x()};
    }
    append(pattern.mesh, panel);
  }
  const int width = columns + 1, back = width * (rows + 1);
  const auto sew = [&](int from, int to) { pattern.seams.push_back({{from, to}, {back + from, back + to}}); };
  sew(0, neck);
  sew(columns - neck, columns);
  sew(width * armhole, width * rows);
  sew(width * armhole + columns, width * rows + columns);
  return pattern;
}

TriangleMesh make_tshirt(double cell) {
  const Field field = offset(body_field(kTop, 0.06), 0.009);
  return wall(field, cell, join({above(0.90), neckline()}, cuffs(0.34)));
}

TriangleMesh make_shirt(double cell, double lift_deg) {
  const Field field = lift_arms(offset(body_field(kTop, 0.06), 0.010), lift_deg);
  return wall(field, cell, join({above(0.90), neckline()}, cuffs(0.60)));
}

TriangleMesh make_trousers(double cell) {
  return wall(offset(body_field(kBottom, 0.03), 0.009), cell, {below(1.03), above(0.13)}, 0);
}

TriangleMesh make_skirt(double cell) { return wall(worn_skirt_field(), cell, {below(1.04), above(0.5)}); }

TriangleMesh make_shirt_over_skirt(double cell) {
  const Field field = unite(offset(body_field(kTop, 0.06), 0.012), offset(worn_skirt_field(), 0.008));
  return wall(field, cell, join({above(0.93), neckline()}, cuffs(0.34)));
}

TriangleMesh make_coat(double cell) {
  const Field field = unite(offset(body_field(kTop, 0.08), 0.022), offset(skirt_field(), 0.012));
  TriangleMesh shell = wall(field, cell, join({above(0.55), neckline()}, cuffs(0.60)));
  const auto is_open = [&](const Triangle& t) {  // in front
    const Vec3 middle = (shell.positions[t[0]] + shell.positions[t[1]] + shell.positions[t[2]]) / 3;
    return std::abs(middle.x()) < 1.2 * cell && middle.z() > 0;
  };
  std::erase_if(shell.triangles, is_open);
  shell = clean_mesh(shell, {.is_cloth = false}).mesh;
  const std::vector<Vec3> normals = compute_normals(shell);
  TriangleMesh lining = shell;
  for (std::size_t v = 0; v < normals.size(); ++v) lining.positions[v] -= 1e-3 * normals[v];
  append(shell, lining);
  return shell;
}

TriangleMesh make_scarf(double cell) {
  constexpr double kTurns = 3.1, kWidth = 0.055, kApart = 0.005;
  const auto place = [&](double across, double down) {
    const double turn = 2 * kPi * kTurns * across, radius = 0.088 + kApart * kTurns * across;
    return Vec3(radius * std::cos(turn), 1.545 - kWidth * down, radius * std::sin(turn) - 0.005);
  };
  return weave(static_cast<int>(2 * kPi * 0.095 * kTurns / cell), static_cast<int>(kWidth / cell), place);
}

TriangleMesh make_pleated_dress(double cell) {
  const TriangleMesh bodice = wall(bodice_field(), cell, join({above(kWaist), neckline()}, cuffs(0.19)));
  TriangleMesh dress;
  int panel = 0;
  const auto add = [&](TriangleMesh piece) {
    const Vec3 aside = (0.1e-3 + 0.1e-3 * panel) * Vec3(panel % 2 ? 1 : -1, 0.5, panel % 3 ? 1 : -1);
    for (Vec3& p : piece.positions) p += aside;
    append(dress, piece);
    ++panel;
  };
  for (const double from_deg : {-45.0, 45.0, 135.0, 225.0})
    add(sector(bodice, from_deg, from_deg + 90, kSnap * cell));
  for (int sixth = 0; sixth < 6; ++sixth) add(make_pleats(cell, sixth));
  return dress;
}

TriangleMesh make_sheet(double side, int num_cells) {
  TriangleMesh mesh =
      build_grid_mesh({.size_x = side, .size_z = side, .cells_x = num_cells, .cells_z = num_cells},
                      GridDiagonals::alternating);
  for (Vec3& p : mesh.positions) p += Vec3(-side / 2, 1.87, -side / 2);
  return mesh;
}

}  // namespace weft::engine::wardrobe
