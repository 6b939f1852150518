#include "weft/mesh/sample_meshes.h"

#include "weft/core/angle.h"
#include "weft/core/random.h"

namespace weft::engine {

TriangleMesh build_random_mesh(const Grid& grid, std::uint64_t seed) {
  TriangleMesh mesh = build_grid_mesh(grid, GridDiagonals::alternating);
  Random random(seed);
  for (int j = 1; j < grid.cells_z; ++j) {
    for (int i = 1; i < grid.cells_x; ++i) {
      mesh.positions[grid.index(i, j)] +=
          Vec3(random.uniform(-0.3, 0.3) * grid.spacing_x(), 0, random.uniform(-0.3, 0.3) * grid.spacing_z());
    }
  }
  mesh.triangles.clear();
  for (int j = 0; j < grid.cells_z; ++j) {
    for (int i = 0; i < grid.cells_x; ++i) {
      const int a = grid.index(i, j), b = grid.index(i + 1, j), c = grid.index(i + 1, j + 1),
                d = grid.index(i, j + 1);
      const auto& p = mesh.positions;
      if ((p[a] - p[c]).norm() < (p[b] - p[d]).norm()) {
        mesh.triangles.push_back({a, d, c});
        mesh.triangles.push_back({a, c, b});
      } else {
        mesh.triangles.push_back({a, d, b});
        mesh.triangles.push_back({d, c, b});
      }
    }
  }
  return mesh;
}

TriangleMesh build_disc_mesh(double radius, int num_rings) {
  TriangleMesh mesh;
  mesh.positions.push_back(Vec3::Zero());
  const auto index = [](int ring, int k) {
    return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + k % (6 * ring);
  };
  for (int ring = 1; ring <= num_rings; ++ring) {
    for (int k = 0; k < 6 * ring; ++k) {
      const auto [s, c] = sin_cos_deg(60.0 * k / ring);
      mesh.positions.push_back(radius * ring / num_rings * Vec3(c, 0, -s));
    }
    // Each sixth of a ring has `ring` outer edges and one fewer inside.
    for (int sixth = 0; sixth < 6; ++sixth) {
      for (int k = 0; k < ring; ++k) {
        const int outer = sixth * ring + k, inner = sixth * (ring - 1) + k;
        mesh.triangles.push_back({index(ring, outer), index(ring, outer + 1), index(ring - 1, inner)});
        if (k + 1 < ring)
          mesh.triangles.push_back(
              {index(ring - 1, inner), index(ring, outer + 1), index(ring - 1, inner + 1)});
      }
    }
  }
  return mesh;
}

}  // namespace weft::engine
