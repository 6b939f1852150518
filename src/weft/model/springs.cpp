#include "weft/model/springs.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace weft::engine {
namespace {

/// Of the two vertices opposite to an edge, at rest: with the angle of the mesh between the triangles.
double distance_across(const RestMesh& mesh, const Edge& edge) {
  const Vec3 &p = mesh.positions[edge.opposite[0]], &q = mesh.positions[edge.opposite[1]];
  if (mesh.at_rest.empty()) return (p - q).norm();
  struct Tip {
    double along, height;  // from the edge's middle, and from the edge [m]
  };
  const auto lay = [](const Vec3& tip, const Vec3& end) {
    const Vec3 axis = end.normalized();
    return Tip{tip.dot(axis) - 0.5 * end.norm(), tip.cross(axis).norm()};
  };
  std::array<Tip, 2> tips;
  std::array<Vec3, 2> upright;  // from the edge to the tips in the mesh
  for (int side = 0; side < 2; ++side) {
    const int t = edge.triangles[side], tip = edge.opposite[side];
    tips[side] = lay(mesh.between(t, edge.a, tip), mesh.between(t, edge.a, edge.b));
    const Vec3 axis = (mesh.positions[edge.b] - mesh.positions[edge.a]).normalized(),
               to = mesh.positions[tip] - mesh.positions[edge.a];
    upright[side] = (to - to.dot(axis) * axis).normalized();
  }
  const auto& [first, second] = tips;
  const double along = first.along - second.along;
  const double cosine = std::clamp(upright[0].dot(upright[1]), -1.0, 1.0),
               apart = first.height - second.height;
  return std::sqrt(along * along + apart * apart + 2 * first.height * second.height * (1 - cosine));
}

}  // namespace

std::string_view to_string(SpringModel model) {
  switch (model) {
    case SpringModel::basic:
      return "basic";
    case SpringModel::simplified:
      return "simplified";
    case SpringModel::alternating:
      break;
  }
  return "alternating";
}

GridDiagonals diagonals_of(SpringModel model) {
  return model == SpringModel::simplified ? GridDiagonals::parallel : GridDiagonals::alternating;
}

std::vector<Spring> build_grid_springs(const Grid& grid, SpringModel model) {
  const double dx = grid.spacing_x(), dz = grid.spacing_z(), diagonal = std::sqrt(dx * dx + dz * dz);
  const int nx = grid.num_columns(), nz = grid.num_rows();
  std::vector<Spring> springs;
  const auto add = [&](int i, int j, int di, int dj, SpringKind kind, double rest_length) {
    if (i + di >= 0 && i + di < nx && j + dj < nz) {
      springs.push_back({grid.index(i, j), grid.index(i + di, j + dj), kind, rest_length});
    }
  };
  for (int j = 0; j < nz; ++j) {
    for (int i = 0; i < nx; ++i) {
      add(i, j, 1, 0, SpringKind::structural, dx);
      add(i, j, 0, 1, SpringKind::structural, dz);
      const bool both = model == SpringModel::basic;
      if (both || is_main_diagonal(diagonals_of(model), i, j)) add(i, j, 1, 1, SpringKind::shear, diagonal);
      if (both || !is_main_diagonal(diagonals_of(model), i - 1, j))
        add(i, j, -1, 1, SpringKind::shear, diagonal);
      add(i, j, 2, 0, SpringKind::bend, 2 * dx);
      add(i, j, 0, 2, SpringKind::bend, 2 * dz);
    }
  }
  return springs;
}

std::vector<Spring> build_mesh_springs(const RestMesh& mesh) {
  std::vector<Spring> springs;
  const std::vector<Edge> edges = build_edges(mesh);
  for (const Edge& edge : edges)
    springs.push_back({edge.a, edge.b, SpringKind::structural, edge_length(mesh, edge)});
  for (const Edge& edge : edges) {
    const bool inner = edge.num_triangles == 2 && edge.opposite[0] != edge.opposite[1];
    if (inner)
      springs.push_back({edge.opposite[0], edge.opposite[1], SpringKind::bend, distance_across(mesh, edge)});
  }
  return springs;
}

}  // namespace weft::engine
