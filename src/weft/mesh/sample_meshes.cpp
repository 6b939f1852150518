#include "weft/mesh/sample_meshes.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <utility>

#include "weft/core/angle.h"
#include "weft/core/random.h"
#include "weft/mesh/solid.h"

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

TriangleMesh build_geodesic_mesh(double radius, int divisions) {
  constexpr double kGolden = std::numbers::phi;
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double a : {-1.0, 1.0}) {
      for (const double b : {-kGolden, kGolden}) {
        Vec3 corner = Vec3::Zero();
        corner[axis] = a;
        corner[(axis + 1) % 3] = b;
        mesh.positions.push_back(corner);
      }
    }
  }
  const auto is_near = [&](int i, int j) { return (mesh.positions[i] - mesh.positions[j]).norm() < 2.1; };
  for (int i = 0; i < 12; ++i) {
    for (int j = i + 1; j < 12; ++j) {
      for (int k = j + 1; k < 12; ++k) {
        if (!is_near(i, j) || !is_near(j, k) || !is_near(k, i)) continue;
        const Vec3 &a = mesh.positions[i], &b = mesh.positions[j], &c = mesh.positions[k];
        mesh.triangles.push_back(a.dot(b.cross(c)) > 0 ? Triangle{i, j, k} : Triangle{i, k, j});
      }
    }
  }
  for (int n = 0; n < divisions; ++n) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [found, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.positions.size()));
      if (is_new) mesh.positions.emplace_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
      return found->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& p : mesh.positions) p *= radius / p.norm();
  return mesh;
}

TriangleMesh build_cushion_mesh(double side, int num_cells, double gap) {
  const Grid grid{.size_x = side, .size_z = side, .cells_x = num_cells, .cells_z = num_cells};
  TriangleMesh mesh = build_grid_mesh(grid, GridDiagonals::alternating);
  const int count = mesh.num_vertices();
  std::vector<int> other(static_cast<std::size_t>(count));  // of a vertex, that of the lower sheet
  for (int j = 0; j <= num_cells; ++j) {
    for (int i = 0; i <= num_cells; ++i) {
      const int v = grid.index(i, j);
      mesh.positions[v] -= Vec3(0.5 * side, 0, 0.5 * side);
      other[v] = v;
      if (i == 0 || j == 0 || i == num_cells || j == num_cells) continue;
      other[v] = mesh.num_vertices();
      mesh.positions.push_back(mesh.positions[v] - Vec3(0, 0.5 * gap, 0));
      mesh.positions[v].y() += 0.5 * gap;
    }
  }
  const std::vector<Triangle> upper = mesh.triangles;
  for (const auto& [a, b, c] : upper) mesh.triangles.push_back({other[a], other[c], other[b]});
  if (compute_signed_volume(mesh) < 0) {
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  return mesh;
}

}  // namespace weft::engine
