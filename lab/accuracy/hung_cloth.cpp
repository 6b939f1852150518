#include "lab/accuracy/hung_cloth.h"

#include <fmt/core.h>

#include <cmath>
#include <numeric>

#include "weft/core/angle.h"
#include "weft/error.h"

namespace weft::engine::lab {
namespace {

HungCloth hang(std::string name, std::shared_ptr<const ClothTopology> topology, const ClothMaterial& material,
               const std::vector<int>& pinned) {
  HungCloth cloth{
      std::move(name), build_cloth_model(topology, material), make_state(topology->mesh.positions), {}};
  for (const int i : pinned) {
    cloth.environment.pins.particle.push_back(i);
    cloth.environment.pins.position.push_back(topology->mesh.positions[i]);
  }
  return cloth;
}

std::shared_ptr<const ClothTopology> build_topology(const Grid& grid, const std::string& springs) {
  if (springs == "mesh") return build_mesh_topology(build_grid_mesh(grid, GridDiagonals::alternating));
  for (const SpringModel m : {SpringModel::basic, SpringModel::simplified, SpringModel::alternating}) {
    if (to_string(m) == springs) return build_grid_topology(grid, m);
  }
  throw InputError("--model must be basic, simplified, alternating or mesh, not " + springs);
}

/// The first particle of ring r > 0, which has 6 r.
int first_of_ring(int r) { return 1 + 3 * r * (r - 1); }

/// The k-th particle of ring r, counted around.
int on_ring(int r, int k) { return r == 0 ? 0 : first_of_ring(r) + k % (6 * r); }

TriangleMesh make_disc_mesh(int num_rings, double radius) {
  TriangleMesh mesh;
  mesh.positions.push_back(Vec3::Zero());
  for (int r = 1; r <= num_rings; ++r) {
    for (int k = 0; k < 6 * r; ++k) {
      const SinCos turn = sin_cos_deg(60.0 * k / r);
      mesh.positions.push_back(radius * r / num_rings * Vec3(turn.cos, 0, turn.sin));
    }
  }
  // Each sixth of a ring has one triangle more that points inwards than that point outwards.
  for (int r = 1; r <= num_rings; ++r) {
    for (int sixth = 0; sixth < 6; ++sixth) {
      for (int k = 0; k < r; ++k) {
        const int outer = sixth * r + k, inner = sixth * (r - 1) + k;
        mesh.triangles.push_back({on_ring(r, outer), on_ring(r, outer + 1), on_ring(r - 1, inner)});
        if (k + 1 < r)
          mesh.triangles.push_back({on_ring(r, outer + 1), on_ring(r - 1, inner + 1), on_ring(r - 1, inner)});
      }
    }
  }
  return mesh;
}

}  // namespace

HungCloth make_hung_sheet(int particles_per_side, const std::string& springs, const ClothMaterial& material) {
  const Grid grid{.cells_x = particles_per_side - 1, .cells_z = particles_per_side - 1};
  return hang("sheet " + std::to_string(particles_per_side) + "²", build_topology(grid, springs), material,
              {0, grid.cells_x});
}

HungCloth make_hung_strip(int cells_across, int cells_along, const ClothMaterial& material, double width) {
  if (width == 0) width = static_cast<double>(cells_across) / cells_along;
  const Grid grid{.size_x = width, .cells_x = cells_across, .cells_z = cells_along};
  std::vector<int> row(static_cast<std::size_t>(grid.num_columns()));
  std::iota(row.begin(), row.end(), 0);
  return hang(fmt::format("strip {}×{}", grid.num_columns(), grid.num_rows()),
              build_grid_topology(grid, SpringModel::simplified), material, row);
}

HungCloth make_chain(const std::vector<Vec3>& places, double mass, double rest_length, double stiffness) {
  auto topology = std::make_shared<ClothTopology>();
  topology->mesh.positions = places;
  topology->area.assign(places.size(), mass);  // of density 1
  for (int i = 0; i + 1 < static_cast<int>(places.size()); ++i)
    topology->springs.push_back({i, i + 1, SpringKind::structural, rest_length});
  topology->table = build_neighbour_table(topology->num_particles(), topology->springs);
  return hang("chain of " + std::to_string(places.size()), topology, {.density = 1, .structural = stiffness},
              {});
}

HungCloth make_hung_disc(int num_rings, const ClothMaterial& material) {
  const auto topology = build_mesh_topology(make_disc_mesh(num_rings, 0.5));
  const int first = on_ring(num_rings, 0), quarter = on_ring(num_rings, 6 * num_rings / 4);
  return hang("disc of " + std::to_string(topology->num_particles()), topology, material, {first, quarter});
}

double rms_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace weft::engine::lab
