#include "lab/textile/specimen.h"

#include <cmath>

#include "weft/core/angle.h"
#include "weft/forces/membrane_patch.h"
#include "weft/forces/spring.h"
#include "weft/mesh/sample_meshes.h"
#include "weft/model/fabric_springs.h"
#include "weft/world/measures.h"

namespace weft::engine::lab {
namespace {

constexpr int kIterations = 60;    // of conjugate gradients per step
constexpr double kSettled = 1e-5;  // of the size
constexpr int kStepsPerLook = 30;  // between two checks for rest
constexpr int kMaxLooks = 200;
constexpr double kStepPerRoot = 0.04;  // step over √size: a fortieth of a strip's period [s/√m]
constexpr std::uint64_t kMeshSeed = 1;

std::vector<Vec3> positions(const ClothState& state) {
  std::vector<Vec3> x;
  for (std::size_t i = 0; i < state.x.size(); ++i) x.push_back(state.position(i));
  return x;
}

double largest_move(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

TriangleMesh make_triangles(const Grid& grid, SpecimenMesh mesh, int straight_column) {
  TriangleMesh triangles = mesh == SpecimenMesh::grid ? build_grid_mesh(grid, GridDiagonals::alternating)
                                                      : build_random_mesh(grid, kMeshSeed);
  for (int j = 0; j < grid.num_rows(); ++j)
    triangles.positions[grid.index(straight_column, j)].x() = straight_column * grid.spacing_x();
  return triangles;
}

/// A material without springs.
ClothMaterial bare_material(const Fabric& fabric) {
  return {.density = fabric.density, .structural = 0, .shear = 0, .bend = 0};
}

/// Model data of a fabric on a mesh.
struct Laid {
  std::shared_ptr<const ClothTopology> topology;
  ClothMaterial material;
  std::shared_ptr<const ClothElements> elements;
};

Laid lay_on_grid(const Fabric& fabric, const Grid& grid, double warp_deg, bool has_springs) {
  const GridWarp warp = std::fmod(warp_deg, 180) == 0 ? GridWarp::first_axis : GridWarp::second_axis;
  Laid laid{build_grid_topology(grid, SpringModel::alternating), bare_material(fabric), nullptr};
  if (!has_springs) {
    laid.elements = build_grid_elements(grid, laid.topology->mesh, warp, fabric);
    return laid;
  }
  set_fabric_springs(make_grid_springs(grid, CellDiagonals::alternating, warp, fabric, "specimen"), fabric,
                     laid.material);
  laid.elements = build_grid_bending_elements(grid, warp, fabric);
  return laid;
}

Laid lay_on_mesh(const Fabric& fabric, TriangleMesh triangles, double warp_deg, bool has_springs) {
  Laid laid{build_mesh_topology(std::move(triangles)), bare_material(fabric), nullptr};
  const TriangleMesh& mesh = laid.topology->mesh;
  const auto [s, c] = sin_cos_deg(warp_deg);
  const WarpField warp = warp_from_direction(mesh, {c, 0, s});
  if (!has_springs) {
    laid.elements = build_mesh_elements(mesh, warp, fabric);
    return laid;
  }
  set_fabric_springs(make_mesh_springs(mesh, warp, fabric, "specimen"), *laid.topology, fabric,
                     laid.material);
  laid.elements = build_mesh_bending_elements(mesh, warp, fabric);
  return laid;
}

void stop(ClothState& state) {
  for (std::size_t i = 0; i < state.v.size(); ++i) state.v.set(i, Vec3::Zero());
  state.history.step = 0;
}

}  // namespace

Fabric find_elastic_fabric(std::string_view name) {
  Fabric fabric = find_fabric(name);
  fabric.bend_hysteresis_warp = fabric.bend_hysteresis_weft = fabric.bend_set = 0;
  return fabric;
}

Specimen make_rectangle(const Fabric& fabric, const Grid& grid, SpecimenMesh mesh,
                        const RectangleOptions& options) {
  const bool has_springs = options.membrane == SpecimenMembrane::springs;
  const bool is_grid = mesh == SpecimenMesh::grid && std::fmod(options.warp_deg, 90) == 0;
  const Laid laid = is_grid ? lay_on_grid(fabric, grid, options.warp_deg, has_springs)
                            : lay_on_mesh(fabric, make_triangles(grid, mesh, options.straight_column),
                                          options.warp_deg, has_springs);
  Specimen specimen;
  specimen.model = build_cloth_model(laid.topology, laid.material, laid.elements);
  specimen.state = make_state(laid.topology->mesh.positions);
  return specimen;
}

void clamp(Specimen& specimen, const std::function<std::optional<Vec3>(const Vec3&)>& place) {
  PinTargets& pins = specimen.environment.pins;
  pins = {};
  for (int i = 0; i < specimen.model->num_particles(); ++i) {
    const std::optional<Vec3> target = place(specimen.rest()[i]);
    if (!target) continue;
    pins.particle.push_back(i);
    pins.position.push_back(*target);
    specimen.state.set_position(i, *target);
  }
}

bool settle(Specimen& specimen, double size) {
  const auto integrator = make_newton({.iterations = kIterations});
  const auto jobs = make_serial_jobs();
  const double step = kStepPerRoot * std::sqrt(size);
  double energy = 0;
  std::vector<Vec3> before = positions(specimen.state);
  for (int look = 0; look < kMaxLooks; ++look) {
    for (int s = 0; s < kStepsPerLook; ++s) {
      integrator->advance(*specimen.model, specimen.environment, step, *jobs, specimen.state);
      const double now = compute_kinetic_energy(*specimen.model, specimen.state);
      if (now < energy) stop(specimen.state);
      energy = now < energy ? 0 : now;
    }
    const std::vector<Vec3> after = positions(specimen.state);
    if (largest_move(before, after) < kSettled * size) return true;
    before = after;
  }
  return false;
}

std::vector<Vec3> compute_membrane_forces(const Specimen& specimen) {
  const ClothElements& elements = *specimen.model->elements;
  const std::vector<Vec3> x = positions(specimen.state);
  std::vector<Vec3> force(x.size(), Vec3::Zero());
  for (const MembranePatch& patch : elements.patches) {
    const PatchCorners f = patch_force(patch, elements.law(), corners_of(patch, x));
    for (int v = 0; v < patch.num_vertices(); ++v) force[patch.vertices[v]] += f[v];
  }
  const std::vector<Spring>& springs = specimen.model->topology->springs;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    const auto& [i, j, kind, rest_length] = springs[s];
    const Vec3 f = spring_force(specimen.model->stiffness(static_cast<int>(s)), rest_length, x[j] - x[i]);
    force[i] += f;
    force[j] -= f;
  }
  return force;
}

}  // namespace weft::engine::lab
