#include "weft/run/reach.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace weft::engine {
namespace {

constexpr double kBelow = 0.05;   // end of a fall below the lowest collider, as a share of cloth's size [1]
constexpr double kLevel = 0.999;  // least y of the normal of a floor [1]

std::optional<double> find_floor(const World& world) {
  for (const Collider& collider : world.colliders()) {
    const ColliderShape shape = shape_at(collider, world.time());
    const Plane* plane = std::get_if<Plane>(&shape);
    if (plane && plane->normal.y() > kLevel) return plane->point.y();
  }
  return std::nullopt;
}

Eigen::AlignedBox3d box_around(const ColliderShape& shape) {
  Eigen::AlignedBox3d box;
  const auto extend = [&](const Vec3& center, double radius) {
    box.extend(center - Vec3::Constant(radius));
    box.extend(center + Vec3::Constant(radius));
  };
  if (const Sphere* sphere = std::get_if<Sphere>(&shape)) {
    extend(sphere->center, sphere->radius);
  } else if (const Capsule* capsule = std::get_if<Capsule>(&shape)) {
    for (const Vec3& end : {capsule->a, capsule->b}) extend(end, capsule->radius);
  } else if (const OrientedBox* solid = std::get_if<OrientedBox>(&shape)) {
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 signs(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      box.extend(solid->center + solid->rotation * signs.cwiseProduct(solid->half_size));
    }
  } else if (const MeshShape* mesh = std::get_if<MeshShape>(&shape)) {
    for (int v = 0; v < mesh->mesh->num_vertices(); ++v) box.extend(mesh->vertex(v));
  }
  return box;
}

/// Positions of hanging cloth: each particle straight below its nearest pin, at its rest distance from it.
void add_hanging(const ClothModel& model, const ClothState& state, const std::vector<Pin>& pins,
                 std::vector<Vec3>& points) {
  const std::vector<Vec3>& rest = model.topology->mesh.positions;
  for (int i = 0; i < model.num_particles(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    int holder = i;
    for (const Pin& pin : pins) {
      for (const int p : pin.particles) {
        const double distance = (rest[i] - rest[p]).norm();
        if (distance >= nearest) continue;
        nearest = distance;
        holder = p;
      }
    }
    points.push_back(state.position(holder) - nearest * Vec3::UnitY());
  }
}

}  // namespace

std::vector<Vec3> find_reach(const World& world) {
  Eigen::AlignedBox3d bodies, cloth;
  for (const Collider& collider : world.colliders())
    bodies.extend(box_around(shape_at(collider, world.time())));
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothState& state = world.state(world.cloth(c));
    for (std::size_t i = 0; i < state.x.size(); ++i) cloth.extend(state.position(i));
  }
  const double size = cloth.isEmpty() ? 1 : cloth.diagonal().norm();
  const std::optional<double> floor = find_floor(world);
  double bottom = cloth.isEmpty() ? 0 : cloth.min().y() - size;
  if (!bodies.isEmpty()) bottom = bodies.min().y() - kBelow * size;
  if (floor) bottom = *floor;

  std::vector<Vec3> points;
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothState& state = world.state(world.cloth(c));
    const std::size_t first = points.size();
    for (std::size_t i = 0; i < state.x.size(); ++i) points.push_back(state.position(i));
    if (!world.pins(world.cloth(c)).empty()) {
      add_hanging(world.model(world.cloth(c)), state, world.pins(world.cloth(c)), points);
      continue;
    }
    const std::size_t end = points.size();
    for (std::size_t p = first; p < end; ++p)
      points.emplace_back(points[p].x(), std::min(points[p].y(), bottom), points[p].z());
  }
  if (floor) {
    for (Vec3& p : points) p.y() = std::max(p.y(), *floor);
  }
  for (int corner = 0; corner < 8 && !bodies.isEmpty(); ++corner)
    points.push_back(bodies.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  return points;
}

}  // namespace weft::engine
