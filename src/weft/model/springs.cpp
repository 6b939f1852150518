#include "weft/model/springs.h"

#include <cmath>

namespace weft::engine {

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

std::vector<Spring> build_mesh_springs(const TriangleMesh& mesh) {
  std::vector<Spring> springs;
  const auto add = [&](int i, int j, SpringKind kind) {
    springs.push_back({i, j, kind, (mesh.positions[i] - mesh.positions[j]).norm()});
  };
  const std::vector<Edge> edges = build_edges(mesh);
  for (const Edge& edge : edges) add(edge.a, edge.b, SpringKind::structural);
  for (const Edge& edge : edges) {
    const bool inner = edge.num_triangles == 2 && edge.opposite[0] != edge.opposite[1];
    if (inner) add(edge.opposite[0], edge.opposite[1], SpringKind::bend);
  }
  return springs;
}

}  // namespace weft::engine
