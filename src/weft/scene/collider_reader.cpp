#include "weft/scene/scene_sections.h"

namespace weft {
namespace {

ColliderShape read_sphere(TomlTable& collider) {
  Sphere sphere;
  collider.require({"radius"}, "a number above 0 in m");
  collider.read("center", sphere.center, any_number("m"));
  collider.read("radius", sphere.radius, above_zero("m"));
  return sphere;
}

ColliderShape read_plane(TomlTable& collider) {
  Plane plane;
  collider.read("point", plane.point, any_number("m"));
  if (collider.read("normal", plane.normal, any_number())) {
    if (plane.normal.norm() < 1e-12) {
      collider.get("normal").mistake("expected a direction, found a vector without length");
    } else {
      plane.normal.normalize();
    }
  }
  return plane;
}

/// Of a shape that cannot be read nothing else is judged, for what else belongs to it is not known.
ColliderShape read_shape(TomlTable& collider) {
  collider.require({"shape"}, "\"sphere\" or \"plane\"");
  const TomlValue shape = collider.get("shape");
  const auto* name = shape ? shape.node().as_string() : nullptr;
  const bool is_planned = name && (*name == "box" || *name == "capsule" || *name == "mesh");
  if (is_planned) {
    shape.mistake(quote(name->get()) + " is not there yet; there are \"sphere\" and \"plane\"");
  } else if (shape) {
    const int choice = shape.find_choice({"sphere", "plane"});
    if (choice == 0) return read_sphere(collider);
    if (choice == 1) return read_plane(collider);
  }
  collider.allow_any_keys();
  return Sphere();
}

}  // namespace

std::vector<KeyFrame> read_motion(TomlTable& owner) {
  std::vector<KeyFrame> frames;
  for (TomlTable& table : owner.tables("motion")) {
    KeyFrame frame;
    const bool is_in_order = read_time(table, frames, frame);
    table.read("position", frame.translation, any_number("m"));
    table.read("rotation", frame.angles_deg, any_number("degrees"), "[0, 90, 0]");
    if (is_in_order) frames.push_back(frame);
  }
  return frames;
}

Collider read_collider(TomlTable table, int number) {
  Collider collider;
  collider.name = number == 1 ? "collider" : "collider " + std::to_string(number);
  collider.shape = read_shape(table);
  table.read("name", collider.name);
  table.read("friction", collider.friction, not_negative());
  collider.motion = RigidMotion(read_motion(table));
  table.refuse("up", "only collider meshes can be turned, and they are not there yet");
  return collider;
}

}  // namespace weft
