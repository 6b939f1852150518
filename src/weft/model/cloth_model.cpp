#include "weft/model/cloth_model.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>

#include "weft/error.h"

namespace weft::engine {
namespace {

std::uint64_t next_id() {
  static std::atomic<std::uint64_t> counter{0};
  return ++counter;
}

void check_factors(const std::vector<double>& factors, std::size_t num_springs) {
  if (factors.empty()) return;
  if (factors.size() != num_springs)
    throw InputError("the cloth has " + std::to_string(num_springs) + " springs and " +
                     std::to_string(factors.size()) + " spring factors; expected one per spring, or none");
  for (std::size_t s = 0; s < factors.size(); ++s) {
    if (!(factors[s] >= 0) || !std::isfinite(factors[s]))
      throw InputError("the factor of spring " + std::to_string(s) + " is " + std::to_string(factors[s]) +
                       "; expected a finite number not below 0");
  }
}

}  // namespace

double ClothModel::stiffness(int spring) const {
  const Spring& s = topology->springs[spring];
  const double factor = material.spring_factors.empty() ? 1.0 : material.spring_factors[spring];
  if (!material.structural_z || s.kind != SpringKind::structural) return factor * stiffness(s.kind);
  const Grid& grid = *topology->grid;
  const int column = s.i % grid.num_columns(), row = s.i / grid.num_columns();
  const bool is_along_x = s.j == s.i + 1;
  const bool is_on_border =
      is_along_x ? row == 0 || row == grid.cells_z : column == 0 || column == grid.cells_x;
  return factor * (is_on_border ? 0.5 : 1.0) * (is_along_x ? material.structural : *material.structural_z);
}

std::shared_ptr<const ClothTopology> build_grid_topology(const Grid& grid, SpringModel model) {
  require_valid(grid);
  auto topology = std::make_shared<ClothTopology>();
  topology->mesh = build_grid_mesh(grid, diagonals_of(model));
  topology->springs = build_grid_springs(grid, model);
  topology->area = compute_grid_areas(grid);
  topology->grid = grid;
  topology->spring_model = model;
  return topology;
}

std::shared_ptr<const ClothTopology> build_mesh_topology(RestMesh mesh, Seams seams) {
  require_valid(mesh);
  auto topology = std::make_shared<ClothTopology>();
  topology->mesh = std::move(mesh);
  topology->springs = build_mesh_springs(topology->mesh);
  topology->area = compute_vertex_areas(topology->mesh);
  topology->table = build_neighbour_table(topology->num_particles(), topology->springs);
  topology->seams = std::move(seams);
  return topology;
}

std::shared_ptr<const ClothModel> build_cloth_model(std::shared_ptr<const ClothTopology> topology,
                                                    const ClothMaterial& material,
                                                    std::shared_ptr<const ClothElements> elements) {
  auto model = std::make_shared<ClothModel>();
  model->id = next_id();
  model->topology = std::move(topology);
  model->material = material;
  model->elements = std::move(elements);
  const ClothTopology& t = *model->topology;
  check_factors(material.spring_factors, t.springs.size());
  if (t.grid && !material.spring_factors.empty())
    model->own_table = build_neighbour_table(t.num_particles(), t.springs);

  for (const double area : t.area) model->mass.push_back(material.density * area);
  model->stiffness_sum.assign(t.num_particles(), 0.0);
  std::vector<int> springs_around(t.num_particles(), 0);
  for (std::size_t s = 0; s < t.springs.size(); ++s) {
    const double k = model->stiffness(static_cast<int>(s));
    for (const int p : {t.springs[s].i, t.springs[s].j}) {
      model->stiffness_sum[p] += k;
      ++springs_around[p];
    }
  }
  if (model->elements) {
    for (const Coupling& c : model->elements->couplings) {
      for (const int p : {c.i, c.j}) model->stiffness_sum[p] += c.stiffness;
    }
  }
  for (const int s : model->table().spring) {
    const double k = s < 0 ? 0.0 : model->stiffness(s);
    model->entry_stiffness.push_back(static_cast<float>(k));
  }
  for (int i = 0; i < t.num_particles(); ++i) {
    const double inv_mass = 1 / model->mass[i];
    model->max_stiffness_rate = std::max(model->max_stiffness_rate, model->stiffness_sum[i] * inv_mass);
    model->max_damping_rate =
        std::max(model->max_damping_rate, material.damping * springs_around[i] * inv_mass);
  }
  return model;
}

std::shared_ptr<const ClothModel> with_gas(const ClothModel& model, const Gas& gas) {
  auto filled = std::make_shared<ClothModel>(model);
  filled->gas = gas;
  return filled;
}

std::shared_ptr<const ClothModel> build_heavier_model(const ClothModel& model,
                                                      const std::vector<double>& added) {
  auto heavier = std::make_shared<ClothModel>(model);
  heavier->id = next_id();
  for (std::size_t i = 0; i < added.size(); ++i) heavier->mass[i] += added[i];
  return heavier;
}

}  // namespace weft::engine
