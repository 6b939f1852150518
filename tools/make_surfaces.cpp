// Makes meshes of scenes: make_surfaces SCENES writes, into SCENES/contact, folded_sheet.obj, tube.obj, funnel.obj
// and legs_0.obj to legs_6.obj, frames of one mesh; into SCENES/pressure cushion.obj and ball.obj.
//
// Those of contact are swept polylines: along z (a sheet), or around an axis (a tube, a funnel).

#include <cstdio>
#include <exception>

#include "weft/core/angle.h"
#include "weft/io/obj_reader.h"
#include "weft/mesh/sample_meshes.h"

namespace weft::engine {
namespace {

using Polyline = std::vector<Vec3>;  // in the plane z = 0

/// Rounds to whole micrometres, for short files (adding 0 turns -0 into 0).
Vec3 rounded(const Vec3& x) { return (x * 1e6).array().round() / 1e6 + 0.0; }

Mat3 rotation_about(const Vec3& axis, double angle_deg) {
  const SinCos angle = sin_cos_deg(angle_deg);
  const Mat3 along = axis * axis.transpose();
  Mat3 across;
  across << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return along + angle.cos * (Mat3::Identity() - along) + angle.sin * across;  // Rodrigues
}

/// Joins neighbouring copies of a polyline by triangles, the last to the first if `closed`.
TriangleMesh join(const std::vector<Polyline>& copies, bool closed) {
  TriangleMesh mesh;
  const int num_copies = static_cast<int>(copies.size()), length = static_cast<int>(copies[0].size());
  for (const Polyline& copy : copies) {
    for (const Vec3& x : copy) mesh.positions.push_back(rounded(x));
  }
  for (int i = 0; i < (closed ? num_copies : num_copies - 1); ++i) {
    for (int j = 0; j + 1 < length; ++j) {
      const int a = i * length + j, b = a + 1;
      const int c = (i + 1) % num_copies * length + j, d = c + 1;
      if ((i + j) % 2 == 0) {  // alternating diagonals: equal stiffness in both directions
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {a, d, c}});
      } else {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {b, d, c}});
      }
    }
  }
  return mesh;
}

TriangleMesh sweep(const Polyline& line, double width, int num_cells) {
  std::vector<Polyline> copies(num_cells + 1, line);
  for (int i = 0; i <= num_cells; ++i) {
    for (Vec3& x : copies[i]) x.z() = width * i / num_cells - width / 2;
  }
  return join(copies, false);
}

TriangleMesh turn(const Polyline& line, const Vec3& axis, int num_cells) {
  std::vector<Polyline> copies;
  for (int i = 0; i < num_cells; ++i) {
    const Mat3 rotation = rotation_about(axis, 360.0 * i / num_cells);
    copies.push_back({});
    for (const Vec3& x : line) copies.back().push_back(rotation * x);
  }
  return join(copies, true);
}

/// Points along a straight line, without its end.
void add_line(Polyline& line, const Vec3& from, const Vec3& to, int num_cells) {
  for (int k = 0; k < num_cells; ++k) line.push_back(from + (to - from) * k / num_cells);
}

/// Points along half a circle from `from` up by `height`, bulging to `side` (±1), without its end.
void add_fold(Polyline& line, const Vec3& from, double height, double side, int num_cells) {
  const double radius = height / 2;
  for (int k = 0; k < num_cells; ++k) {
    const Mat3 rotation = rotation_about({0, 0, 1}, side * 180.0 * k / num_cells);
    line.push_back(from + Vec3(0, radius, 0) + rotation * Vec3(0, -radius, 0));
  }
}

/// 0.5 m by 1.02 m, folded in three: an S with straight layers 2 cm apart.
TriangleMesh make_folded_sheet() {
  constexpr double kHalf = 0.16, kGap = 0.02;
  constexpr int kLayerCells = 32, kFoldCells = 3, kWidthCells = 40;
  Polyline line;
  add_line(line, {-kHalf, 0, 0}, {kHalf, 0, 0}, kLayerCells);
  add_fold(line, {kHalf, 0, 0}, kGap, 1, kFoldCells);
  add_line(line, {kHalf, kGap, 0}, {-kHalf, kGap, 0}, kLayerCells);
  add_fold(line, {-kHalf, kGap, 0}, kGap, -1, kFoldCells);
  add_line(line, {-kHalf, 2 * kGap, 0}, {kHalf, 2 * kGap, 0}, kLayerCells);
  line.push_back({kHalf, 2 * kGap, 0});
  return sweep(line, 0.5, kWidthCells);
}

/// 1 m long, of radius 0.1 m, around the x axis.
TriangleMesh make_tube() {
  constexpr int kLengthCells = 84, kRoundCells = 52;
  Polyline line;
  add_line(line, {-0.5, 0.1, 0}, {0.5, 0.1, 0}, kLengthCells);
  line.push_back({0.5, 0.1, 0});
  return turn(line, {1, 0, 0}, kRoundCells);
}

/// Around the y axis: from a rim of radius 0.5 m at a height of 1.4 m down to a spout of radius 0.1 m.
TriangleMesh make_funnel() {
  return turn({{0.5, 1.4, 0}, {0.3, 1.2, 0}, {0.1, 1.0, 0}, {0.1, 0.85, 0}}, {0, 1, 0}, 32);
}

/// Frame `k` of a body whose two legs swing through each other. The legs are capsules along z, at a distance
/// of `kApart[k]` from the plane x = 0, slightly thicker with every frame.
constexpr double kApart[] = {0.1, 0.1, 0.075, 0.05, 0.05, 0.075, 0.1};

TriangleMesh make_legs(int k) {
  constexpr int kRings = 10;
  const double apart = kApart[k], radius = 0.1 + 0.1 * (0.2 - apart);
  TriangleMesh legs;
  for (const double side : {-1.0, 1.0}) {
    const TriangleMesh leg =
        make_capsule_mesh({side * apart, 0, -0.35}, {side * apart, 0, 0.35}, radius, kRings);
    const int first = legs.num_vertices();
    for (const Vec3& x : leg.positions) legs.positions.push_back(rounded(x));
    for (const auto& [a, b, c] : leg.triangles) legs.triangles.push_back({first + a, first + b, first + c});
  }
  return legs;
}

TriangleMesh round(TriangleMesh mesh) {
  for (Vec3& p : mesh.positions) p = rounded(p);
  return mesh;
}

TriangleMesh make_cushion() { return round(build_cushion_mesh(0.5, 32, 0.004)); }
TriangleMesh make_ball() { return round(build_geodesic_mesh(0.15, 3)); }

}  // namespace
}  // namespace weft::engine

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_surfaces SCENES\n");
    return 2;
  }
  const std::filesystem::path scenes = argv[1], folder = scenes / "contact";
  try {
    weft::engine::write_obj(folder / "folded_sheet.obj", weft::engine::make_folded_sheet());
    weft::engine::write_obj(folder / "tube.obj", weft::engine::make_tube());
    weft::engine::write_obj(folder / "funnel.obj", weft::engine::make_funnel());
    for (int k = 0; k < static_cast<int>(std::size(weft::engine::kApart)); ++k)
      weft::engine::write_obj(folder / ("legs_" + std::to_string(k) + ".obj"), weft::engine::make_legs(k));
    weft::engine::write_obj(scenes / "pressure/cushion.obj", weft::engine::make_cushion());
    weft::engine::write_obj(scenes / "pressure/ball.obj", weft::engine::make_ball());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_surfaces: %s\n", error.what());
    return 1;
  }
  return 0;
}
