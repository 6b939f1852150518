#include "weft/scene/scene_world.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>

#include "weft/core/error.h"
#include "weft/model/fabric_springs.h"
#include "weft/scene/scene_meshes.h"

namespace weft {
namespace {

/// A cloth's topology, and which of its particles each vertex of the mesh file became (empty for grids).
struct LoadedCloth {
  std::shared_ptr<const ClothTopology> topology;
  std::vector<int> particle_of_vertex;
  std::vector<CornerUv> uv;  // of the mesh file; may be empty
};

/// The axis of a grid that warp goes along, if it is one.
std::optional<GridWarp> grid_warp(const FabricDesc& fabric) {
  constexpr double kAlong = 0.999999;  // least cosine of the angle between them
  const Vec3 direction = fabric.warp.value_or(Vec3::UnitX()).normalized();
  if (std::abs(direction.x()) > kAlong) return GridWarp::first_axis;
  if (std::abs(direction.z()) > kAlong) return GridWarp::second_axis;
  return {};
}

/// A grid whose warp is along neither axis is a mesh like any other.
LoadedCloth load(const ClothSceneDesc& desc, std::vector<std::string>& warnings,
                 std::vector<std::string>& notes) {
  if (const Grid* grid = std::get_if<Grid>(&desc.shape)) {
    if (desc.fabric && !grid_warp(*desc.fabric))
      return {build_mesh_topology(build_grid_mesh(*grid, diagonals_of(desc.model))), {}, {}};
    return {build_grid_topology(*grid, desc.model), {}, {}};
  }
  std::vector<CornerUv> uv;
  CleanMesh clean =
      load_mesh(std::get<MeshFile>(desc.shape), MeshUse::cloth, "cloth \"" + desc.name + "\"", warnings, &uv);
  notes.insert(notes.end(), clean.notes.begin(), clean.notes.end());
  return {build_mesh_topology(std::move(clean.mesh)), std::move(clean.vertex_of_source), std::move(uv)};
}

CellDiagonals cell_diagonals(SpringModel model) {
  switch (model) {
    case SpringModel::basic:
      return CellDiagonals::both;
    case SpringModel::alternating:
      return CellDiagonals::alternating;
    case SpringModel::simplified:
      break;
  }
  return CellDiagonals::parallel;
}

struct Stuff {
  ClothMaterial material;
  std::shared_ptr<const ClothElements> elements;
};

Stuff make_springs_on_grid(const ClothSceneDesc& desc, const Grid& grid, std::vector<std::string>& warnings) {
  const FabricDesc& fabric = *desc.fabric;
  const std::optional<GridWarp> warp = grid_warp(fabric);
  if (!warp)
    throw InputError("cloth \"" + desc.name +
                     "\": springs can only have warp along one of the grid's axes, " +
                     "[1, 0, 0] or [0, 0, 1]; use membrane = \"triangle\" for other directions");
  const GridSprings springs =
      make_grid_springs(grid, cell_diagonals(desc.model), *warp, fabric.numbers, fabric.name);
  for (const std::string& warning : springs.warnings)
    warnings.push_back("cloth \"" + desc.name + "\": " + warning);
  ClothMaterial material = desc.material;
  set_fabric_springs(springs, fabric.numbers, material);
  return {material, build_grid_bending_elements(grid, *warp, fabric.numbers)};
}

/// Whether most of the surface is nearer to upright than to level, at rest.
bool stands_upright(const TriangleMesh& mesh) {
  double upright = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 area = (mesh.positions[j] - mesh.positions[i]).cross(mesh.positions[k] - mesh.positions[i]);
    upright += area.norm() - std::sqrt(2.0) * std::abs(area.y());
  }
  return upright > 0;
}

/// Along the direction that is given, or as the mesh's texture coordinates say; without either, along the
/// body in what is worn.
WarpField find_warp(const ClothSceneDesc& desc, const LoadedCloth& loaded,
                    std::vector<std::string>& warnings) {
  const std::string who = "cloth \"" + desc.name + "\": ";
  const TriangleMesh& mesh = loaded.topology->mesh;
  std::optional<Vec3> direction = desc.fabric->warp;
  if (!direction && loaded.uv.empty()) {
    const bool stands = stands_upright(mesh);
    direction = stands ? Vec3::UnitY() : Vec3::UnitX();
    warnings.push_back(who +
                       "its mesh has no texture coordinates, which would say where warp goes; it goes " +
                       (stands ? "upwards, warp = [0, 1, 0]" : "along x, warp = [1, 0, 0]"));
  }
  WarpField warp = direction ? warp_from_direction(mesh, *direction) : warp_from_uv(mesh, loaded.uv);
  if (warp.num_guessed == 0) return warp;
  warnings.push_back(
      who + (direction ? "warp is perpendicular to " : "texture coordinates do not say where warp goes in ") +
      std::to_string(warp.num_guessed) + (warp.num_guessed == 1 ? " triangle" : " triangles") +
      ", which got another axis");
  return warp;
}

Stuff make_springs_on_mesh(const ClothSceneDesc& desc, const LoadedCloth& loaded,
                           std::vector<std::string>& warnings) {
  const Fabric& fabric = desc.fabric->numbers;
  const ClothTopology& topology = *loaded.topology;
  const WarpField warp = find_warp(desc, loaded, warnings);
  const MeshSprings springs = make_mesh_springs(topology.mesh, warp, fabric, desc.fabric->name);
  for (const std::string& warning : springs.warnings)
    warnings.push_back("cloth \"" + desc.name + "\": " + warning);
  ClothMaterial material = desc.material;
  set_fabric_springs(springs, topology, fabric, material);
  return {material, build_mesh_bending_elements(topology.mesh, warp, fabric)};
}

Stuff make_stuff(const ClothSceneDesc& desc, const LoadedCloth& loaded, std::vector<std::string>& warnings) {
  const ClothTopology& topology = *loaded.topology;
  if (!desc.fabric) return {desc.material, nullptr};
  const FabricDesc& fabric = *desc.fabric;
  const Grid* grid = std::get_if<Grid>(&desc.shape);
  if (fabric.membrane == Membrane::springs) {
    return grid ? make_springs_on_grid(desc, *grid, warnings) : make_springs_on_mesh(desc, loaded, warnings);
  }
  if (topology.grid)
    return {desc.material, build_grid_elements(*grid, topology.mesh, *grid_warp(fabric), fabric.numbers)};
  return {desc.material,
          build_mesh_elements(topology.mesh, find_warp(desc, loaded, warnings), fabric.numbers)};
}

/// A thickness that nobody has given is at most half of a mesh's mean edge, so that few neighbours are
/// nearer than it.
void fit_thickness(const ClothSceneDesc& desc, const TriangleMesh& mesh, ClothMaterial& material) {
  constexpr double kShareOfEdge = 0.5;
  if (desc.has_own_thickness) return;
  const std::vector<Edge> edges = build_edges(mesh);
  double sum = 0;
  for (const Edge& e : edges) sum += (mesh.positions[e.b] - mesh.positions[e.a]).norm();
  material.thickness = std::min(material.thickness, kShareOfEdge * sum / static_cast<double>(edges.size()));
}

std::vector<Vec3> place(const std::vector<Vec3>& rest, const ClothSceneDesc& desc) {
  const Mat3 rotation = rotation_from_angles_deg(desc.rotation_deg);
  std::vector<Vec3> positions;
  positions.reserve(rest.size());
  for (const Vec3& p : rest) positions.push_back(rotation * p + desc.position);
  return positions;
}

template <class Region>
std::vector<int> select_inside(const std::vector<Vec3>& positions, const Region& is_inside) {
  std::vector<int> selected;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (is_inside(positions[i])) selected.push_back(static_cast<int>(i));
  }
  return selected;
}

/// Selections become particle numbers.
struct Selector {
  const ClothSceneDesc& cloth;
  const LoadedCloth& loaded;
  const std::vector<Vec3>& positions;

  std::vector<int> operator()(const GridCorner& corner) const {
    const Grid& grid = std::get<Grid>(cloth.shape);
    return {grid.index(corner.i * grid.cells_x, corner.j * grid.cells_z)};
  }

  std::vector<int> operator()(const ParticleIndices& selection) const {
    const bool is_mesh = !loaded.particle_of_vertex.empty();
    const auto count = is_mesh ? loaded.particle_of_vertex.size() : positions.size();
    std::vector<int> selected;
    for (const int index : selection.indices) {
      if (index < 0 || static_cast<std::size_t>(index) >= count) {
        throw InputError("cloth \"" + cloth.name + "\": there is no index " + std::to_string(index) +
                         " to pin; the last one is " + std::to_string(count - 1));
      }
      const int particle = is_mesh ? loaded.particle_of_vertex[index] : index;
      if (particle < 0) {
        throw InputError("cloth \"" + cloth.name + "\": vertex " + std::to_string(index) +
                         " cannot be pinned, for no triangle uses it");
      }
      selected.push_back(particle);
    }
    return selected;
  }

  std::vector<int> operator()(const Box& box) const {
    return select_inside(positions, [&](const Vec3& p) { return box.contains(p); });
  }

  std::vector<int> operator()(const Sphere& sphere) const {
    return select_inside(positions,
                         [&](const Vec3& p) { return (p - sphere.center).norm() <= sphere.radius; });
  }
};

std::vector<int> select(const Selector& selector, const ParticleSelection& selection, const char* what) {
  std::vector<int> selected = std::visit(selector, selection);
  std::sort(selected.begin(), selected.end());
  selected.erase(std::unique(selected.begin(), selected.end()), selected.end());
  if (!selected.empty()) return selected;
  throw InputError("cloth \"" + selector.cloth.name + "\": " + what +
                   " holds no particle; regions are in world coordinates [m], after position and rotation");
}

/// Multiplies the factors of each spring, which are 1 if there are none yet, by those of regions.
void multiply_spring_factors(const ClothSceneDesc& desc, const LoadedCloth& loaded,
                             const std::vector<Vec3>& positions, std::vector<double>& factors) {
  const std::vector<Spring>& springs = loaded.topology->springs;
  for (const StiffenDesc& part : desc.stiffened) {
    factors.resize(springs.size(), 1.0);
    std::vector<char> is_inside(positions.size(), 0);
    for (const int p : select({desc, loaded, positions}, part.select, "a stiffened region")) is_inside[p] = 1;
    for (std::size_t s = 0; s < springs.size(); ++s) {
      if (is_inside[springs[s].i] && is_inside[springs[s].j]) factors[s] *= part.factor;
    }
  }
}

std::vector<Pin> make_pins(const ClothSceneDesc& desc, const LoadedCloth& loaded,
                           const std::vector<Vec3>& positions) {
  std::vector<Pin> pins;
  for (const PinDesc& pin : desc.pins) {
    pins.push_back({select({desc, loaded, positions}, pin.select, "a pin's region"), RigidMotion(pin.motion),
                    pin.pivot});
  }
  return pins;
}

void warn_about_start(const World& world, std::vector<std::string>& warnings) {
  const auto passing = world.passing_pairs();
  for (int c = 0; c < world.num_cloths(); ++c) {
    const std::string& cloth = world.name(world.cloth(c));
    std::vector<Vec3> positions;
    for (std::size_t i = 0; i < world.state(world.cloth(c)).x.size(); ++i)
      positions.push_back(world.state(world.cloth(c)).position(i));
    for (const Collider& collider : world.colliders()) {
      const std::array<std::string, 2> pair{cloth, collider.name};
      if (std::find(passing.begin(), passing.end(), pair) != passing.end()) continue;
      const int inside = count_inside(shape_at(collider, 0), positions);
      if (inside == 0) continue;
      warnings.push_back("cloth \"" + cloth + "\" starts with " + std::to_string(inside) +
                         (inside == 1 ? " particle" : " particles") + " inside collider \"" + collider.name +
                         "\"; move them apart");
    }
  }
}

void untangle(SceneWorld& built) {
  const auto start = std::chrono::steady_clock::now();
  const UntangleReport report = built.world.untangle();
  if (report.rounds == 0) return;
  built.untangle_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::vector<std::string>& warnings = built.warnings;
  char how[96];
  std::snprintf(how, sizeof how, "; set apart in %d rounds, by %.3g m at most", report.rounds,
                report.farthest);
  for (const std::string& what : report.crossed)
    warnings.push_back("at the start " + what + (report.left.empty() ? how : ""));
  for (const std::string& what : report.left)
    warnings.push_back("could not be untangled: " + what + "; move them apart");
}

}  // namespace

int SceneDesc::num_frames() const { return std::max(1, static_cast<int>(std::lround(duration * fps))); }

SceneWorld build_world(const SceneDesc& scene, std::shared_ptr<JobSystem> jobs) {
  SceneWorld result;
  World& world = result.world;
  world.set_jobs(std::move(jobs));
  world.set_gravity(scene.gravity);
  world.set_integrator(scene.solver);
  world.set_division({scene.adaptive, 1 / (scene.fps * scene.max_steps_per_frame)});
  world.set_wind(wind_at(scene.wind, 0));
  world.set_contact(scene.contact);
  for (const ColliderSceneDesc& desc : scene.colliders)
    world.add_collider(make_collider(desc, result.warnings));
  for (const ClothSceneDesc& desc : scene.cloths) {
    const LoadedCloth loaded = load(desc, result.warnings, result.notes);
    const std::vector<Vec3> positions = place(loaded.topology->mesh.positions, desc);
    Stuff stuff = make_stuff(desc, loaded, result.warnings);
    multiply_spring_factors(desc, loaded, positions, stuff.material.spring_factors);
    if (scene.contact) fit_thickness(desc, loaded.topology->mesh, stuff.material);
    const ClothId id = world.add_cloth({.name = desc.name,
                                        .topology = loaded.topology,
                                        .material = stuff.material,
                                        .elements = stuff.elements,
                                        .positions = positions,
                                        .velocity = desc.velocity});
    world.set_pins(id, make_pins(desc, loaded, positions));
  }
  for (const ContactDesc& rule : scene.contacts) {
    const auto& [a, b] = rule.between;
    if (rule.friction) world.set_friction(a, b, *rule.friction, rule.static_friction);
    world.set_collision(a, b, rule.collide);
  }
  const bool is_repaired = scene.untangle && scene.contact;
  is_repaired ? untangle(result) : warn_about_start(world, result.warnings);
  return result;
}

Wind wind_at(const WindDesc& wind, double time) {
  Wind now{.drag = wind.drag, .air = wind.air, .gusts = wind.gusts};
  if (wind.keys.empty()) return now;
  std::size_t next = 0;
  while (next < wind.keys.size() && wind.keys[next].time <= time) ++next;
  const WindKey& a = wind.keys[next == 0 ? 0 : next - 1];
  const WindKey& b = wind.keys[next == wind.keys.size() ? next - 1 : next];
  const double span = b.time - a.time;
  const double s = span > 0 ? (time - a.time) / span : 0.0;
  now.velocity = a.velocity + s * (b.velocity - a.velocity);
  return now;
}

}  // namespace weft
