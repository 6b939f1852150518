#include "weft/scene/scene_world.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>

#include "weft/core/nearest_name.h"
#include "weft/error.h"
#include "weft/face/convert.h"
#include "weft/face/world_impl.h"
#include "weft/scene/cloth_faces.h"
#include "weft/scene/scene_meshes.h"
#include "weft/scene/scene_start.h"

namespace weft::engine {
namespace {

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

/// Converts selections to particle indices.
struct Selector {
  const ClothSceneDesc& cloth;
  const std::vector<int>& particle_of_vertex;
  const std::vector<Vec3>& positions;

  std::vector<int> operator()(const GridCorner& corner) const {
    const Grid& grid = std::get<Grid>(cloth.shape);
    return {grid.index(corner.i * grid.cells_x, corner.j * grid.cells_z)};
  }

  std::vector<int> operator()(const ParticleIndices& selection) const {
    const auto count = particle_of_vertex.size();
    std::vector<int> selected;
    for (const int index : selection.indices) {
      if (index < 0 || static_cast<std::size_t>(index) >= count) {
        throw InputError("cloth \"" + cloth.name + "\": there is no index " + std::to_string(index) +
                         " to select; the last one is " + std::to_string(count - 1));
      }
      const int particle = particle_of_vertex[index];
      if (particle < 0) {
        throw InputError("cloth \"" + cloth.name + "\": vertex " + std::to_string(index) +
                         " cannot be selected: no triangle uses it");
      }
      selected.push_back(particle);
    }
    return selected;
  }

  std::vector<int> operator()(const GroupName& group) const {
    std::vector<int> selected;
    for (const int vertex : find_group(cloth, group.name)) {
      const int particle = particle_of_vertex[vertex];
      if (particle >= 0) selected.push_back(particle);
    }
    if (selected.empty())
      throw InputError("cloth \"" + cloth.name + "\": group \"" + group.name +
                       "\" cannot be selected: its faces have no area");
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
  throw InputError(
      "cloth \"" + selector.cloth.name + "\": " + what +
      " contains no particle; regions are in world coordinates [m], after position and rotation");
}

/// Rest scales, by vertices of the described shape.
std::vector<RestScale> describe_scales(const ClothSceneDesc& desc, const ClothDesc& described) {
  std::vector<RestScale> scales;
  if (desc.rest_scales.empty()) return scales;
  const Grid* grid = std::get_if<Grid>(&described.shape);
  const std::vector<Vec3> positions =
      place(grid ? build_grid_mesh(*grid, diagonals_of(described.model)).positions
                 : to_engine(std::get<weft::TriangleMesh>(described.shape).positions),
            desc);
  std::vector<int> vertices(positions.size());
  std::iota(vertices.begin(), vertices.end(), 0);
  for (const RestScaleDesc& scale : desc.rest_scales)
    scales.push_back(
        {select({desc, vertices, positions}, scale.select, "a rest scale"), scale.warp, scale.weft});
  return scales;
}

/// The collider of the name; empty for a pin that follows none.
std::optional<ColliderId> find_followed(const ClothSceneDesc& cloth, const PinDesc& pin,
                                        const weft::World& world) {
  if (pin.follow.empty()) return {};
  std::vector<std::string> names;
  for (int c = 0; c < world.num_colliders(); ++c) {
    names.push_back(world.name(world.collider(c)));
    if (names.back() == pin.follow) return world.collider(c);
  }
  const std::string nearest = find_nearest(pin.follow, names);
  throw InputError("cloth \"" + cloth.name + "\": a pin follows \"" + pin.follow +
                   "\", but there is no collider of this name" +
                   (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
}

/// The initial positions of a cloth's particles [m].
std::vector<Vec3> initial_positions(const ClothSceneDesc& desc, ClothId id, const weft::World& world) {
  return place(WorldAccess::engine(world).model(id).topology->mesh.positions, desc);
}

/// Pins, stiffened regions and gas.
void hold_cloth(const ClothSceneDesc& desc, ClothId id, weft::World& built) {
  const std::vector<Vec3> positions = initial_positions(desc, id, built);
  const Selector selector{desc, built.notes(id).particle_of_vertex, positions};
  for (const StiffenDesc& part : desc.stiffened)
    built.stiffen(id, select(selector, part.select, "a stiffened region"), part.factor);
  built.set_pins(id, describe_pins(desc, id, built));
  if (desc.pressure != 0 || desc.is_sealed) built.set_pressure(id, desc.pressure, desc.is_sealed);
}

bool do_collide(const World& world, const std::string& cloth, const std::string& collider) {
  const auto pairs = world.non_colliding_pairs();
  return std::ranges::find(pairs, std::array{cloth, collider}) == pairs.end();
}

void warn_about_start(const World& world, std::vector<std::string>& warnings) {
  for (int c = 0; c < world.num_cloths(); ++c) {
    const std::string& cloth = world.name(world.cloth(c));
    const std::vector<Vec3> positions = positions_of(world.state(world.cloth(c)));
    for (const Collider& collider : world.colliders()) {
      if (!do_collide(world, cloth, collider.name)) continue;
      const int inside = count_inside(shape_at(collider, world.time()), positions);
      if (inside == 0) continue;
      warnings.push_back("cloth \"" + cloth + "\" starts with " + std::to_string(inside) +
                         (inside == 1 ? " particle" : " particles") + " inside collider \"" + collider.name +
                         "\"; move them apart");
    }
  }
}

/// Cloth inside an open body, where contact keeps it.
void warn_about_open_bodies(const SceneDesc& scene, const World& world, std::vector<std::string>& warnings) {
  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    const PlacedMesh* placed = std::get_if<PlacedMesh>(&scene.colliders[k].shape);
    if (!placed || placed->solid) continue;
    const std::string& body = world.colliders()[k].name;
    const TriangleMesh filled =
        fill_open_shells(std::get<MeshShape>(shape_at(world.colliders()[k], world.time())));
    for (int c = 0; c < world.num_cloths(); ++c) {
      const std::string& cloth = world.name(world.cloth(c));
      if (!do_collide(world, cloth, body)) continue;
      const int inside = count_inside(filled, positions_of(world.state(world.cloth(c))));
      if (inside == 0) continue;
      warnings.push_back(std::to_string(inside) + (inside == 1 ? " particle" : " particles") +
                         " of cloth \"" + cloth + "\" start within collider \"" + body +
                         "\", which is open: contact keeps them there; solid = true fills its holes, solid = "
                         "false accepts this");
    }
  }
}

void untangle(World& world, const OnPreparation& on_preparation, SceneNotes& built) {
  const auto start = std::chrono::steady_clock::now();
  const UntangleReport report = world.untangle([&](int round) {
    if (on_preparation) on_preparation("repairing the start, round " + std::to_string(round));
  });
  if (report.rounds == 0) return;
  built.untangle_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::vector<std::string>& warnings = built.warnings;
  char how[96];
  std::snprintf(how, sizeof how, "; moved apart in %d rounds, by at most %.3g m", report.rounds,
                report.farthest);
  for (const std::string& what : report.crossed)
    warnings.push_back("at the start " + what + (report.left.empty() ? how : ""));
  for (const std::string& what : report.left)
    warnings.push_back("could not be untangled: " + what + "; move them apart");
}

/// Steps up to time 0, and stops the cloth there.
void settle(const SceneDesc& scene, const OnPreparation& on_preparation, PublicScene& built) {
  const int steps = std::max(1, static_cast<int>(std::ceil(scene.settle / scene.step_length() - 1e-9)));
  for (int s = 0; s < steps; ++s) {
    if (on_preparation)
      on_preparation("settling, step " + std::to_string(s + 1) + " of " + std::to_string(steps));
    built.settling.push_back(built.world.step(scene.settle / steps));
    if (!built.settling.back().ok)
      throw InputError("scene.settle: the simulation failed in step " + std::to_string(s + 1) + " of " +
                       std::to_string(steps) + "; a lower value, or 0, starts without it");
  }
  World& world = WorldAccess::engine(built.world);
  world.set_time(0);
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothId cloth = world.cloth(c);
    world.set_velocities(cloth, std::vector<Vec3>(world.state(cloth).x.size(), Vec3::Zero()));
  }
}

/// Calls on_preparation, which must outlive it, at most every tenth of a second.
OnPreparation at_intervals(const OnPreparation& on_preparation) {
  using Clock = std::chrono::steady_clock;
  if (!on_preparation) return {};
  return [&on_preparation, last = Clock::time_point()](const std::string& what) mutable {
    constexpr std::chrono::milliseconds kInterval(100);
    if (Clock::now() - last < kInterval) return;
    last = Clock::now();
    on_preparation(what);
  };
}

void append(const std::vector<std::string>& messages, std::vector<std::string>& to) {
  to.insert(to.end(), messages.begin(), messages.end());
}

}  // namespace

int SceneDesc::num_frames() const { return std::max(1, static_cast<int>(std::lround(duration * fps))); }
double SceneDesc::step_length() const { return 1 / (fps * steps_per_frame); }

PublicScene place_scene(const SceneDesc& scene, std::shared_ptr<JobSystem> jobs,
                        const OnPreparation& on_preparation) {
  PublicScene result;
  World& world = WorldAccess::engine(result.world);
  world.set_jobs(std::move(jobs));
  world.set_time(-scene.settle);
  world.set_gravity(scene.gravity);
  world.set_integrator(scene.solver);
  world.set_division({scene.adaptive, 1 / (scene.fps * scene.max_steps_per_frame)});
  result.world.set_wind(describe_wind(scene.wind));
  world.set_contact(scene.contact);
  for (const ColliderSceneDesc& desc : scene.colliders) {
    const ColliderId id =
        result.world.add_collider(describe_collider(desc, scene.settle, result.warnings, on_preparation));
    append(result.world.warnings(id), result.warnings);
  }
  for (const ClothSceneDesc& desc : scene.cloths) {
    ClothDesc described = describe_cloth(desc, scene.contact, result.warnings);
    described.rest_scales = describe_scales(desc, described);
    const ClothId id = result.world.add_cloth(std::move(described));
    append(result.world.notes(id).warnings, result.warnings);
    append(result.world.notes(id).done, result.notes);
    hold_cloth(desc, id, result.world);
  }
  for (const ContactDesc& rule : scene.contacts) {
    const auto& [a, b] = rule.between;
    if (rule.friction) world.set_friction(a, b, *rule.friction, rule.static_friction);
    world.set_collision(a, b, rule.collide);
  }
  return result;
}

PublicScene build_scene(const SceneDesc& scene, std::shared_ptr<JobSystem> jobs, const SceneStart* start,
                        const OnPreparation& on_preparation) {
  const OnPreparation now_and_then = at_intervals(on_preparation);
  PublicScene result = place_scene(scene, std::move(jobs), now_and_then);
  if (start) set_start(*start, result);
  if (scene.contact) warn_about_open_bodies(scene, WorldAccess::engine(result.world), result.warnings);
  const bool is_repaired = scene.untangle && scene.contact;
  World& world = WorldAccess::engine(result.world);
  is_repaired ? untangle(world, now_and_then, result) : warn_about_start(world, result.warnings);
  if (scene.settle > 0) settle(scene, now_and_then, result);
  return result;
}

SceneWorld build_world(const SceneDesc& scene, std::shared_ptr<JobSystem> jobs,
                       const OnPreparation& on_preparation) {
  PublicScene built = build_scene(scene, std::move(jobs), nullptr, on_preparation);
  return {std::move(static_cast<SceneNotes&>(built)), std::move(WorldAccess::engine(built.world))};
}

std::vector<weft::Pin> describe_pins(const ClothSceneDesc& cloth, ClothId id, const weft::World& world) {
  const std::vector<Vec3> positions = initial_positions(cloth, id, world);
  const Selector selector{cloth, world.notes(id).particle_of_vertex, positions};
  std::vector<weft::Pin> pins;
  for (const PinDesc& pin : cloth.pins)
    pins.push_back({.particles = select(selector, pin.select, "a pin's region"),
                    .motion = from_engine(pin.motion),
                    .pivot = from_engine(pin.pivot),
                    .follow = find_followed(cloth, pin, world),
                    .stiffness = pin.stiffness,
                    .damping = pin.damping});
  return pins;
}

weft::Wind describe_wind(const WindDesc& wind) {
  weft::Wind result{.drag = wind.drag, .air = wind.air, .gusts = wind.gusts};
  for (const WindKey& key : wind.keys) result.keys.push_back({key.time, from_engine(key.velocity)});
  return result;
}

}  // namespace weft::engine
