#include "weft/scene/scene_world.h"

#include <algorithm>
#include <cmath>

#include "weft/core/error.h"
#include "weft/scene/scene_meshes.h"

namespace weft {
namespace {

/// A cloth's topology, and which of its particles each vertex of the mesh file became (empty for grids).
struct LoadedCloth {
  std::shared_ptr<const ClothTopology> topology;
  std::vector<int> particle_of_vertex;
};

LoadedCloth load(const ClothSceneDesc& desc, std::vector<std::string>& warnings) {
  if (const Grid* grid = std::get_if<Grid>(&desc.shape)) return {build_grid_topology(*grid, desc.model), {}};
  CleanMesh clean =
      load_mesh(std::get<MeshFile>(desc.shape), MeshUse::cloth, "cloth \"" + desc.name + "\"", warnings);
  return {build_mesh_topology(std::move(clean.mesh)), std::move(clean.vertex_of_source)};
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

std::vector<Pin> make_pins(const ClothSceneDesc& desc, const LoadedCloth& loaded,
                           const std::vector<Vec3>& positions) {
  std::vector<Pin> pins;
  for (const PinDesc& pin : desc.pins) {
    std::vector<int> selected = std::visit(Selector{desc, loaded, positions}, pin.select);
    std::sort(selected.begin(), selected.end());
    selected.erase(std::unique(selected.begin(), selected.end()), selected.end());
    if (selected.empty()) {
      throw InputError("cloth \"" + desc.name +
                       "\": a pin's region holds no particle; regions are in world " +
                       "coordinates [m], after position and rotation");
    }
    pins.push_back({std::move(selected), RigidMotion(pin.motion), pin.pivot});
  }
  return pins;
}

void warn_about_start(const std::vector<Collider>& colliders, const std::string& cloth,
                      const std::vector<Vec3>& positions, std::vector<std::string>& warnings) {
  for (const Collider& collider : colliders) {
    const int inside = count_inside(shape_at(collider, 0), positions);
    if (inside == 0) continue;
    warnings.push_back("cloth \"" + cloth + "\" starts with " + std::to_string(inside) +
                       (inside == 1 ? " particle" : " particles") + " inside collider \"" + collider.name +
                       "\"; move them apart");
  }
}

}  // namespace

int SceneDesc::num_frames() const { return std::max(1, static_cast<int>(std::lround(duration * fps))); }

SceneWorld build_world(const SceneDesc& scene, std::shared_ptr<JobSystem> jobs) {
  SceneWorld result;
  World& world = result.world;
  world.set_jobs(std::move(jobs));
  world.set_gravity(scene.gravity);
  world.set_wind(wind_at(scene.wind, 0));
  world.set_integrator(scene.solver);
  world.set_contact(scene.contact);
  for (const ColliderSceneDesc& desc : scene.colliders)
    world.add_collider(make_collider(desc, result.warnings));
  for (const ClothSceneDesc& desc : scene.cloths) {
    const LoadedCloth loaded = load(desc, result.warnings);
    const std::vector<Vec3> positions = place(loaded.topology->mesh.positions, desc);
    const ClothId id = world.add_cloth({.name = desc.name,
                                        .topology = loaded.topology,
                                        .material = desc.material,
                                        .positions = positions,
                                        .velocity = desc.velocity});
    world.set_pins(id, make_pins(desc, loaded, positions));
    warn_about_start(world.colliders(), desc.name, positions, result.warnings);
  }
  return result;
}

Wind wind_at(const WindDesc& wind, double time) {
  if (wind.keys.empty()) return {Vec3::Zero(), wind.drag};
  std::size_t next = 0;
  while (next < wind.keys.size() && wind.keys[next].time <= time) ++next;
  const WindKey& a = wind.keys[next == 0 ? 0 : next - 1];
  const WindKey& b = wind.keys[next == wind.keys.size() ? next - 1 : next];
  const double span = b.time - a.time;
  const double s = span > 0 ? (time - a.time) / span : 0.0;
  return {a.velocity + s * (b.velocity - a.velocity), wind.drag};
}

}  // namespace weft
