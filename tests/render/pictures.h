#pragma once
/// Pictures for tests.

#include "weft/mesh/grid.h"
#include "weft/render/picture.h"

namespace weft::engine {

inline std::vector<float> to_floats(const std::vector<Vec3>& points) {
  std::vector<float> floats;
  for (const Vec3& p : points) {
    for (const double c : p) floats.push_back(static_cast<float>(c));
  }
  return floats;
}

inline DrawnMesh draw(const TriangleMesh& mesh, const Look& look) {
  return {.triangles = mesh.triangles,
          .positions = to_floats(mesh.positions),
          .fabric_coordinates = {},
          .look = look};
}

/// A horizontal square sheet of fabric around the given point.
inline DrawnMesh make_sheet(const Vec3& center, double side, const Look& look) {
  TriangleMesh mesh = build_grid_mesh({.size_x = side, .size_z = side, .cells_x = 8, .cells_z = 8},
                                      GridDiagonals::alternating);
  DrawnMesh sheet{.triangles = mesh.triangles, .positions = {}, .fabric_coordinates = {}, .look = look};
  for (Vec3& p : mesh.positions) {
    sheet.fabric_coordinates.push_back(static_cast<float>(p.x()));
    sheet.fabric_coordinates.push_back(static_cast<float>(p.z()));
    p += center - Vec3(side / 2, 0, side / 2);
  }
  sheet.positions = to_floats(mesh.positions);
  return sheet;
}

inline Look fabric(const Color& color, double check_size = 0) {
  return {Look::Kind::fabric, color, check_size};
}
inline Look solid(const Color& color) { return {Look::Kind::solid, color, 0}; }

/// A ball over the ground, and checked cloth next to it.
inline Picture make_still_life() {
  Picture picture;
  picture.meshes.push_back(draw(make_sphere_mesh({0, 0.3, 0}, 0.3, 24), solid({0.6, 0.6, 0.6})));
  picture.meshes.push_back(make_sheet({0.1, 0.62, 0}, 0.8, fabric({0.58, 0.06, 0.05}, 0.05)));
  picture.lines.push_back({.ends = {{-0.6, 0, 0.5}, {-0.6, 0.9, 0.5}}, .color = {0, 0, 0.5}, .width = 4});
  picture.dots.push_back({.positions = {{-0.6, 0.9, 0.5}}, .color = {0, 0, 0.5}, .diameter = 16});
  picture.ground = 0;
  picture.camera.target = {0, 0.35, 0};
  picture.camera.distance = 2.6;
  return picture;
}

}  // namespace weft::engine
