#include "weft/scene/scene_changes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "weft/error.h"
#include "weft/face/convert.h"
#include "weft/face/world_impl.h"
#include "weft/scene/scene_meshes.h"
#include "weft/scene/scene_world.h"

namespace weft::engine {
namespace {

constexpr double kSameSize = 1e-9;  // difference of two lengths by rounding [m]
constexpr double kLag = 0.07;       // of a gliding collider [s]
constexpr double kMaxTurn = 6.3;    // of a gliding collider [rad/s]
constexpr double kArrival = 1e-4;   // distance to the place, and angle, that a glide ends within [m], [rad]

/// A fabric stays a fabric with the same membrane and warp, springs stay springs; cloth that tears, or does not, also.
bool has_same_kind(const ClothSceneDesc& a, const ClothSceneDesc& b) {
  if (a.fabric.has_value() != b.fabric.has_value() || a.has_own_thickness != b.has_own_thickness)
    return false;
  return !a.fabric || (a.fabric->membrane == b.fabric->membrane && a.fabric->warp == b.fabric->warp &&
                       (a.fabric->numbers.strength > 0) == (b.fabric->numbers.strength > 0));
}

bool has_same_fabric(const ClothSceneDesc& a, const ClothSceneDesc& b) {
  return a.fabric == b.fabric && a.material == b.material;
}

/// Whether the pins differ in still ones only.
bool has_same_motions(const ClothSceneDesc& a, const ClothSceneDesc& b) {
  const auto moving = [](std::vector<PinDesc> pins) {
    std::erase_if(pins, [](const PinDesc& pin) { return pin.is_still(); });
    return pins;
  };
  return moving(a.pins) == moving(b.pins);
}

/// The displacement from one shape to another of the same size; empty for other sizes and kinds.
struct Displacement {
  const std::variant<Sphere, Plane, Capsule, PlacedBox, PlacedMesh>& to;

  std::optional<Pose> operator()(const Sphere& from) const {
    const Sphere* other = std::get_if<Sphere>(&to);
    if (!other || other->radius != from.radius) return {};
    return Pose{other->center - from.center};
  }
  std::optional<Pose> operator()(const Plane& from) const {
    const Plane* other = std::get_if<Plane>(&to);
    if (!other || other->normal != from.normal) return {};
    return Pose{other->point - from.point};
  }
  std::optional<Pose> operator()(const Capsule& from) const {
    const Capsule* other = std::get_if<Capsule>(&to);
    if (!other || other->radius != from.radius) return {};
    if (((other->b - other->a) - (from.b - from.a)).norm() > kSameSize) return {};
    return Pose{other->a - from.a};
  }
  std::optional<Pose> operator()(const PlacedBox& from) const {
    const PlacedBox* other = std::get_if<PlacedBox>(&to);
    if (!other || other->half_size != from.half_size) return {};
    const Mat3 turn = rotation_from_angles_deg(other->rotation_deg) *
                      rotation_from_angles_deg(from.rotation_deg).transpose();
    return Pose{other->center - turn * from.center, turn};
  }
  std::optional<Pose> operator()(const PlacedMesh& from) const {
    const PlacedMesh* other = std::get_if<PlacedMesh>(&to);
    if (!other) return {};
    PlacedMesh same = *other;
    same.position = from.position;
    same.rotation_deg = from.rotation_deg;
    if (!(same == from)) return {};
    const Mat3 turn = rotation_from_angles_deg(other->rotation_deg) *
                      rotation_from_angles_deg(from.rotation_deg).transpose();
    return Pose{other->position - turn * from.position, turn};
  }
};

/// Whether a collider differs in friction or place only.
bool is_same_body(const ColliderSceneDesc& a, const ColliderSceneDesc& b) {
  if (a.name != b.name || !(a.motion == b.motion)) return false;
  if (a.shape == b.shape) return true;
  return a.motion.is_still() && std::visit(Displacement{b.shape}, a.shape).has_value();
}

/// The number of colliders, from the first, that stay.
std::size_t count_kept(const SceneDesc& now, const SceneDesc& wanted) {
  const std::size_t count = std::min(now.colliders.size(), wanted.colliders.size());
  std::size_t kept = 0;
  while (kept < count && is_same_body(now.colliders[kept], wanted.colliders[kept])) ++kept;
  return kept;
}

/// Whether a pin follows a collider that would be taken away.
bool loses_followed(const SceneDesc& now, const SceneDesc& wanted) {
  for (std::size_t k = count_kept(now, wanted); k < now.colliders.size(); ++k) {
    for (const ClothSceneDesc& cloth : now.cloths) {
      for (const PinDesc& pin : cloth.pins) {
        if (pin.follow == now.colliders[k].name) return true;
      }
    }
  }
  return false;
}

/// A shape as it was when the world got it: the pose that is now wanted is relative to that. A mesh has its own
/// coordinates.
weft::Pose pose_from(const weft::ColliderDesc& added, const ColliderSceneDesc& wanted) {
  std::optional<Pose> moved;
  if (const auto* sphere = std::get_if<weft::Sphere>(&added.shape))
    moved = Displacement{wanted.shape}(Sphere{to_engine(sphere->center), sphere->radius});
  else if (const auto* plane = std::get_if<weft::Plane>(&added.shape))
    moved = Displacement{wanted.shape}(Plane{to_engine(plane->point), to_engine(plane->normal)});
  else if (const auto* capsule = std::get_if<weft::Capsule>(&added.shape))
    moved =
        Displacement{wanted.shape}(Capsule{to_engine(capsule->a), to_engine(capsule->b), capsule->radius});
  else if (const auto* box = std::get_if<weft::OrientedBox>(&added.shape)) {
    const PlacedBox& to = std::get<PlacedBox>(wanted.shape);
    const Mat3 turn = rotation_from_angles_deg(to.rotation_deg) * to_engine(box->rotation).transpose();
    moved = Pose{to.center - turn * to_engine(box->center), turn};
  } else {
    const PlacedMesh& to = std::get<PlacedMesh>(wanted.shape);
    moved = Pose{to.position, rotation_from_angles_deg(to.rotation_deg)};
  }
  return from_engine(moved.value_or(Pose()));
}

/// A point of a shape to move it by, in its own coordinates [m].
Vec3 center_of(const weft::ColliderDesc& added) {
  if (const auto* sphere = std::get_if<weft::Sphere>(&added.shape)) return to_engine(sphere->center);
  if (const auto* plane = std::get_if<weft::Plane>(&added.shape)) return to_engine(plane->point);
  if (const auto* box = std::get_if<weft::OrientedBox>(&added.shape)) return to_engine(box->center);
  if (const auto* capsule = std::get_if<weft::Capsule>(&added.shape))
    return (to_engine(capsule->a) + to_engine(capsule->b)) / 2;
  return Vec3::Zero();
}

/// The share of a way that is made in a step.
double share_of(double way, double max_speed, double dt) {
  if (way < kArrival) return 1;
  return std::min(1 - std::exp(-dt / kLag), max_speed * dt / way);
}

/// The pose after `dt` on the way from one to the other; empty: it is there.
std::optional<Pose> glide(const Pose& from, const Pose& to, const Vec3& center, double dt) {
  const Vec3 start = from.rotation * center + from.translation, end = to.rotation * center + to.translation;
  const Eigen::AngleAxisd turn(Mat3(to.rotation * from.rotation.transpose()));
  const double way = (end - start).norm(), angle = std::abs(turn.angle());
  if (way < kSameSize && angle < kSameSize) return {};
  if (way < kArrival && angle < kArrival) return to;
  const Vec3 place = start + share_of(way, kMaxGlideSpeed, dt) * (end - start);
  const Eigen::AngleAxisd part(share_of(angle, kMaxTurn, dt) * turn.angle(), turn.axis());
  const Mat3 rotation = part.toRotationMatrix() * from.rotation;
  return Pose{place - rotation * center, rotation};
}

/// Particles that still pins hold, ascending, each once.
std::vector<int> held_still(const ClothSceneDesc& desc, ClothId id, const weft::World& world) {
  ClothSceneDesc still = desc;
  std::erase_if(still.pins, [](const PinDesc& pin) { return !pin.is_still(); });
  std::vector<int> particles;
  for (const weft::Pin& pin : describe_pins(still, id, world))
    particles.insert(particles.end(), pin.particles.begin(), pin.particles.end());
  std::ranges::sort(particles);
  return particles;
}

void change_pins(const ClothSceneDesc& now, const ClothSceneDesc& wanted, ClothId id, weft::World& world) {
  const std::vector<int> before = held_still(now, id, world), after = held_still(wanted, id, world);
  std::vector<int> fewer, more;
  std::ranges::set_difference(before, after, std::back_inserter(fewer));
  std::ranges::set_difference(after, before, std::back_inserter(more));
  if (!fewer.empty()) world.unpin(id, fewer);
  if (!more.empty()) world.add_pin(id, {.particles = more});
}

void change_cloths(const SceneDesc& now, const SceneDesc& wanted, weft::World& world) {
  for (std::size_t c = 0; c < now.cloths.size(); ++c) {
    const ClothSceneDesc& cloth = wanted.cloths[c];
    const ClothId id = world.cloth(static_cast<int>(c));
    if (!has_same_fabric(now.cloths[c], cloth)) world.set_fabric(id, describe_fabric(cloth));
    if (!(now.cloths[c].pins == cloth.pins)) change_pins(now.cloths[c], cloth, id, world);
    if (now.cloths[c].pressure != cloth.pressure || now.cloths[c].is_sealed != cloth.is_sealed)
      world.set_pressure(id, cloth.pressure, cloth.is_sealed);
  }
}

void change_colliders(const SceneDesc& now, const SceneDesc& wanted, weft::World& world) {
  const std::size_t kept = count_kept(now, wanted);
  for (std::size_t k = 0; k < kept; ++k) {
    const ColliderSceneDesc &from = now.colliders[k], &to = wanted.colliders[k];
    const ColliderId id = world.collider(static_cast<int>(k));
    if (from.friction != to.friction || from.static_friction != to.static_friction)
      world.set_friction(id, to.friction, to.static_friction);
    if (!(from.shape == to.shape)) world.move_collider(id, pose_from(world.description(id), to));
  }
  while (world.num_colliders() > static_cast<int>(kept))
    world.remove(world.collider(world.num_colliders() - 1));
  std::vector<std::string> ignored;  // warnings on meshes, which the first build has reported
  for (std::size_t k = kept; k < wanted.colliders.size(); ++k)
    world.add_collider(describe_collider(wanted.colliders[k], 0, ignored));
}

void change_world(const SceneDesc& now, const SceneDesc& wanted, weft::World& world) {
  World& engine = WorldAccess::engine(world);
  if (now.gravity != wanted.gravity) engine.set_gravity(wanted.gravity);
  if (!(now.solver == wanted.solver)) engine.set_integrator(wanted.solver);
  if (!(now.wind == wanted.wind)) world.set_wind(describe_wind(wanted.wind));
  engine.set_division({wanted.adaptive, 1 / (wanted.fps * wanted.max_steps_per_frame)});
  engine.set_contact(wanted.contact);
  change_cloths(now, wanted, world);
  change_colliders(now, wanted, world);
  if (now.contacts == wanted.contacts && !changes_bodies(now, wanted)) return;
  for (const ContactDesc& rule : wanted.contacts) {
    const auto& [a, b] = rule.between;
    if (rule.friction) engine.set_friction(a, b, *rule.friction, rule.static_friction);
    engine.set_collision(a, b, rule.collide);
  }
}

/// Whether friction and collision of pairs differ in numbers only, so that new ones replace all old ones.
bool has_same_pairs(const SceneDesc& now, const SceneDesc& wanted) {
  return std::equal(now.contacts.begin(), now.contacts.end(), wanted.contacts.begin(), wanted.contacts.end(),
                    [](const ContactDesc& a, const ContactDesc& b) {
                      return a.between == b.between && a.friction.has_value() == b.friction.has_value();
                    });
}

}  // namespace

SceneDesc changeable_part(const SceneDesc& now, const SceneDesc& wanted) {
  SceneDesc next = now;
  next.description = wanted.description;
  next.gravity = wanted.gravity;
  next.fps = wanted.fps;
  next.duration = wanted.duration;
  next.solver = wanted.solver;
  next.solver.is_double = now.solver.is_double;
  next.steps_per_frame = wanted.steps_per_frame;
  next.adaptive = wanted.adaptive;
  next.max_steps_per_frame = wanted.max_steps_per_frame;
  next.contact = wanted.contact;
  next.wind = wanted.wind;
  if (has_same_pairs(now, wanted)) next.contacts = wanted.contacts;
  if (!loses_followed(now, wanted)) next.colliders = wanted.colliders;
  for (std::size_t c = 0; c < std::min(now.cloths.size(), wanted.cloths.size()); ++c) {
    if (has_same_motions(now.cloths[c], wanted.cloths[c])) next.cloths[c].pins = wanted.cloths[c].pins;
    next.cloths[c].pressure = wanted.cloths[c].pressure;
    next.cloths[c].is_sealed = wanted.cloths[c].is_sealed;
    if (!has_same_kind(now.cloths[c], wanted.cloths[c])) continue;
    next.cloths[c].fabric = wanted.cloths[c].fabric;
    next.cloths[c].material = wanted.cloths[c].material;
  }
  return next;
}

std::vector<std::string> find_keys_for_restart(const SceneDesc& now, const SceneDesc& wanted) {
  const SceneDesc next = changeable_part(now, wanted);
  std::vector<std::string> keys;
  const auto compare = [&](bool is_same, const std::string& key) {
    if (!is_same) keys.push_back(key);
  };
  compare(next.settle == wanted.settle, "scene.settle");
  compare(next.cloths.size() == wanted.cloths.size(), "cloth");
  for (std::size_t c = 0; c < std::min(next.cloths.size(), wanted.cloths.size()); ++c) {
    const ClothSceneDesc &a = next.cloths[c], &b = wanted.cloths[c];
    const std::string cloth = "cloth[" + std::to_string(c) + "].";
    compare(a.name == b.name, cloth + "name");
    compare(a.shape == b.shape, cloth + (std::holds_alternative<Grid>(b.shape) ? "grid" : "mesh"));
    compare(a.model == b.model, cloth + "model");
    compare(has_same_kind(a, b), cloth + "fabric");
    compare(a.position == b.position, cloth + "position");
    compare(a.rotation_deg == b.rotation_deg, cloth + "rotation");
    compare(a.velocity == b.velocity, cloth + "velocity");
    compare(a.color == b.color, cloth + "color");
    compare(a.pins == b.pins, cloth + "pin");
    compare(a.stiffened == b.stiffened, cloth + "stiffen");
    compare(a.layer == b.layer, cloth + "layer");
    compare(a.rest == b.rest, cloth + "rest");
    compare(a.rest_scales == b.rest_scales, cloth + "rest_scale");
    compare(a.has_stitches == b.has_stitches, cloth + "stitches");
    compare(a.seams == b.seams && a.seam_time == b.seam_time && a.seam_stiffness == b.seam_stiffness,
            cloth + "seam");
  }
  compare(next.colliders == wanted.colliders, "collider");
  compare(next.contacts == wanted.contacts, "contact");
  compare(next.solver.is_double == wanted.solver.is_double, "solver.precision");
  compare(next.untangle == wanted.untangle, "solver.untangle");
  compare(next.crossed_start == wanted.crossed_start, "solver.crossed_start");
  return keys;
}

bool changes_bodies(const SceneDesc& now, const SceneDesc& wanted) {
  return count_kept(now, wanted) < std::max(now.colliders.size(), wanted.colliders.size());
}

void apply_changes(const SceneDesc& now, const SceneDesc& wanted, weft::World& world) {
  const SceneDesc next = changeable_part(now, wanted);
  try {
    change_world(now, next, world);
  } catch (const InputError&) {
    change_world(next, now, world);
    throw;
  }
}

void glide_colliders(const SceneDesc& scene, double dt, weft::World& world) {
  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    if (!scene.colliders[k].motion.is_still()) continue;
    const ColliderId id = world.collider(static_cast<int>(k));
    const weft::ColliderDesc& added = world.description(id);
    const std::optional<Pose> next = glide(
        to_engine(world.pose(id)), to_engine(pose_from(added, scene.colliders[k])), center_of(added), dt);
    if (next) world.move_collider(id, from_engine(*next));
  }
}

}  // namespace weft::engine
