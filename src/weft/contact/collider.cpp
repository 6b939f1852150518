#include "weft/contact/collider.h"

#include <limits>

namespace weft::engine {
namespace {

/// Contact with meshes uses their vertices, edges and triangles (see contact_system.h), never this distance.
SignedDistance signed_distance(const MeshShape&, const Vec3&) {
  return {std::numeric_limits<double>::infinity(), Vec3::UnitY()};
}

TriangleSignedDistance signed_distance(const MeshShape&, const Vec3&, const Vec3&, const Vec3&, double) {
  return {std::numeric_limits<double>::infinity(), Vec3::UnitX(), Vec3::UnitY()};
}

double support(const Plane&, const Vec3&) { return std::numeric_limits<double>::infinity(); }
double support(const MeshShape&, const Vec3&) { return std::numeric_limits<double>::infinity(); }

Vec3 pivot_of(const Sphere& sphere) { return sphere.center; }
Vec3 pivot_of(const Plane& plane) { return plane.point; }
Vec3 pivot_of(const Capsule& capsule) { return 0.5 * (capsule.a + capsule.b); }
Vec3 pivot_of(const OrientedBox& box) { return box.center; }
Vec3 pivot_of(const MeshShape& mesh) { return mesh.translation; }

struct Mover {
  Pose pose;
  Vec3 pivot;
  double time;

  Vec3 point(const Vec3& p) const { return apply(pose, pivot, p); }

  ColliderShape operator()(const Sphere& s) const { return Sphere{point(s.center), s.radius}; }
  ColliderShape operator()(const Plane& p) const { return Plane{point(p.point), pose.rotation * p.normal}; }
  ColliderShape operator()(const Capsule& c) const { return Capsule{point(c.a), point(c.b), c.radius}; }
  ColliderShape operator()(const OrientedBox& b) const {
    return OrientedBox{point(b.center), b.half_size, pose.rotation * b.rotation};
  }
  ColliderShape operator()(const MeshShape& m) const {
    MeshShape moved = m.at(time);
    moved.rotation = pose.rotation * m.rotation;
    moved.translation = point(m.translation);
    return moved;
  }
};

}  // namespace

MeshShape MeshShape::at(double time) const {
  MeshShape result = *this;
  if (!source) return result;
  std::vector<Vec3> vertices;
  source->evaluate(time, vertices);
  result.deformed = std::make_shared<const std::vector<Vec3>>(std::move(vertices));
  return result;
}

SignedDistance signed_distance(const ColliderShape& shape, const Vec3& p) {
  return std::visit([&](const auto& s) { return signed_distance(s, p); }, shape);
}

TriangleSignedDistance signed_distance(const ColliderShape& shape, const Vec3& a, const Vec3& b,
                                       const Vec3& c, double reach) {
  return std::visit([&](const auto& s) { return signed_distance(s, a, b, c, reach); }, shape);
}

double support(const ColliderShape& shape, const Vec3& normal) {
  return std::visit([&](const auto& s) { return support(s, normal); }, shape);
}

Vec3 pivot(const ColliderShape& shape) {
  return std::visit([](const auto& s) { return pivot_of(s); }, shape);
}

ColliderShape shape_at(const Collider& collider, double time) {
  return std::visit(Mover{collider.motion.at(time), pivot(collider.shape), time}, collider.shape);
}

}  // namespace weft::engine
