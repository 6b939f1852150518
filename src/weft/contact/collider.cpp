#include "weft/contact/collider.h"

namespace weft {
namespace {

SignedDistance distance_to(const Sphere& sphere, const Vec3& p) {
  const Vec3 offset = p - sphere.center;
  const double length = offset.norm();
  const Vec3 normal = length > 0 ? Vec3(offset / length) : Vec3::UnitY();
  return {length - sphere.radius, normal};
}

SignedDistance distance_to(const Plane& plane, const Vec3& p) {
  return {(p - plane.point).dot(plane.normal), plane.normal};
}

Vec3 pivot_of(const Sphere& sphere) { return sphere.center; }
Vec3 pivot_of(const Plane& plane) { return plane.point; }

Sphere moved(const Sphere& sphere, const Pose& pose) {
  return {sphere.center + pose.translation, sphere.radius};
}
Plane moved(const Plane& plane, const Pose& pose) {
  return {plane.point + pose.translation, pose.rotation * plane.normal};
}

}  // namespace

SignedDistance signed_distance(const ColliderShape& shape, const Vec3& p) {
  return std::visit([&](const auto& s) { return distance_to(s, p); }, shape);
}

Vec3 pivot(const ColliderShape& shape) {
  return std::visit([](const auto& s) { return pivot_of(s); }, shape);
}

ColliderShape shape_at(const Collider& collider, double time) {
  const Pose pose = collider.motion.at(time);
  return std::visit([&](const auto& s) -> ColliderShape { return moved(s, pose); }, collider.shape);
}

}  // namespace weft
