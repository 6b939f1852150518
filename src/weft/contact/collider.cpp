#include "weft/contact/collider.h"

#include <algorithm>
#include <limits>

namespace weft {
namespace {

Vec3 direction_or_up(const Vec3& v, double length) { return length > 0 ? Vec3(v / length) : Vec3::UnitY(); }

SignedDistance distance_to(const Sphere& sphere, const Vec3& p) {
  const Vec3 offset = p - sphere.center;
  const double length = offset.norm();
  return {length - sphere.radius, direction_or_up(offset, length)};
}

SignedDistance distance_to(const Plane& plane, const Vec3& p) {
  return {(p - plane.point).dot(plane.normal), plane.normal};
}

SignedDistance distance_to(const Capsule& capsule, const Vec3& p) {
  const Vec3 axis = capsule.b - capsule.a;
  const double length_sq = axis.squaredNorm();
  const double s = length_sq > 0 ? std::clamp((p - capsule.a).dot(axis) / length_sq, 0.0, 1.0) : 0.0;
  return distance_to(Sphere{capsule.a + s * axis, capsule.radius}, p);
}

SignedDistance distance_to(const OrientedBox& box, const Vec3& p) {
  const Vec3 local = box.rotation.transpose() * (p - box.center);
  const Vec3 beyond = local.cwiseAbs() - box.half_size;
  int axis;
  const double deepest = beyond.maxCoeff(&axis);
  if (deepest <= 0) {
    const Vec3 face = local[axis] < 0 ? Vec3(-Vec3::Unit(axis)) : Vec3(Vec3::Unit(axis));
    return {deepest, box.rotation * face};
  }
  const Vec3 outside = local - local.cwiseMax(-box.half_size).cwiseMin(box.half_size);
  const double length = outside.norm();
  return {length, box.rotation * (outside / length)};
}

SignedDistance distance_to(const MeshShape&, const Vec3&) {
  return {std::numeric_limits<double>::infinity(), Vec3::UnitY()};
}

Vec3 pivot_of(const Sphere& sphere) { return sphere.center; }
Vec3 pivot_of(const Plane& plane) { return plane.point; }
Vec3 pivot_of(const Capsule& capsule) { return 0.5 * (capsule.a + capsule.b); }
Vec3 pivot_of(const OrientedBox& box) { return box.center; }
Vec3 pivot_of(const MeshShape& mesh) { return mesh.translation; }

struct Mover {
  Pose pose;
  Vec3 pivot;

  Vec3 point(const Vec3& p) const { return apply(pose, pivot, p); }

  ColliderShape operator()(const Sphere& s) const { return Sphere{point(s.center), s.radius}; }
  ColliderShape operator()(const Plane& p) const { return Plane{point(p.point), pose.rotation * p.normal}; }
  ColliderShape operator()(const Capsule& c) const { return Capsule{point(c.a), point(c.b), c.radius}; }
  ColliderShape operator()(const OrientedBox& b) const {
    return OrientedBox{point(b.center), b.half_size, pose.rotation * b.rotation};
  }
  ColliderShape operator()(const MeshShape& m) const {
    return MeshShape{m.mesh, pose.rotation * m.rotation, point(m.translation)};
  }
};

}  // namespace

SignedDistance signed_distance(const ColliderShape& shape, const Vec3& p) {
  return std::visit([&](const auto& s) { return distance_to(s, p); }, shape);
}

Vec3 pivot(const ColliderShape& shape) {
  return std::visit([](const auto& s) { return pivot_of(s); }, shape);
}

ColliderShape shape_at(const Collider& collider, double time) {
  return std::visit(Mover{collider.motion.at(time), pivot(collider.shape)}, collider.shape);
}

}  // namespace weft
