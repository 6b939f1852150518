#include "weft/scene/collider_edits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace weft::engine {
namespace {

std::string new_name(const std::string& kind, const SceneDesc& scene) {
  const auto is_taken = [&](const std::string& name) {
    return std::ranges::any_of(scene.colliders, [&](const auto& c) { return c.name == name; }) ||
           std::ranges::any_of(scene.cloths, [&](const auto& c) { return c.name == name; });
  };
  std::string name = kind;
  for (int number = 2; is_taken(name); ++number) name = kind + " " + std::to_string(number);
  return name;
}

struct Displacer {
  const Pose& by;

  Vec3 point(const Vec3& p) const { return by.rotation * p + by.translation; }

  void operator()(Sphere& sphere) const { sphere.center = point(sphere.center); }
  void operator()(Plane& plane) const { plane.point = point(plane.point); }
  void operator()(Capsule& capsule) const {
    capsule.a = point(capsule.a);
    capsule.b = point(capsule.b);
  }
  void operator()(PlacedBox& box) const { place(box.center, box.rotation_deg); }
  void operator()(PlacedMesh& mesh) const { place(mesh.position, mesh.rotation_deg); }

 private:
  void place(Vec3& position, Vec3& rotation_deg) const {
    position = point(position);
    if (!by.rotation.isIdentity(0))
      rotation_deg = angles_of(by.rotation * rotation_from_angles_deg(rotation_deg));
  }
};

}  // namespace

std::size_t add_collider(NewCollider kind, const Vec3& center, double size, SceneDesc& scene) {
  ColliderSceneDesc added;
  switch (kind) {
    case NewCollider::ball:
      added = {.name = new_name("ball", scene), .shape = Sphere{center, size}};
      break;
    case NewCollider::box:
      added = {.name = new_name("box", scene),
               .shape = PlacedBox{.center = center, .half_size = Vec3::Constant(size)}};
      break;
    case NewCollider::capsule: {
      const Vec3 half(size, 0, 0);
      added = {.name = new_name("capsule", scene), .shape = Capsule{center - half, center + half, size / 2}};
      break;
    }
    case NewCollider::floor:
      added = {.name = new_name("floor", scene), .shape = Plane{.point = center, .normal = {0, 1, 0}}};
      break;
  }
  scene.colliders.push_back(std::move(added));
  return scene.colliders.size() - 1;
}

void remove_collider(std::size_t index, SceneDesc& scene) {
  const std::string name = scene.colliders[index].name;
  scene.colliders.erase(scene.colliders.begin() + static_cast<std::ptrdiff_t>(index));
  std::erase_if(scene.contacts,
                [&](const ContactDesc& rule) { return rule.between[0] == name || rule.between[1] == name; });
}

bool is_movable(const ColliderSceneDesc& collider) {
  return collider.motion.is_still() && !std::holds_alternative<Plane>(collider.shape);
}

void displace(const Pose& displacement, ColliderSceneDesc& collider) {
  std::visit(Displacer{displacement}, collider.shape);
}

Vec3 angles_of(const Mat3& r) {
  const double y = std::asin(std::clamp(-r(2, 0), -1.0, 1.0));
  const bool is_locked = std::abs(r(2, 0)) > 1 - 1e-12;  // only the sum of the other two counts
  const double x = is_locked ? std::atan2(-r(1, 2), r(1, 1)) : std::atan2(r(2, 1), r(2, 2));
  const double z = is_locked ? 0 : std::atan2(r(1, 0), r(0, 0));
  return Vec3(x, y, z) * 180 / std::numbers::pi;
}

}  // namespace weft::engine
