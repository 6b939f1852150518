/// World: ray casts and closest points.

#include <cmath>
#include <limits>

#include "weft/face/convert.h"
#include "weft/face/world_impl.h"
#include "weft/geometry/distance.h"

namespace weft {
namespace {

using engine::to_engine;

/// Calls visit(cloth, triangle, corners) for every triangle of every cloth.
template <class Visit>
void for_each_triangle(const engine::World& world, const Visit& visit) {
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothId id = world.cloth(c);
    const engine::ClothState& state = world.state(id);
    const std::vector<Triangle>& triangles = world.model(id).topology->mesh.triangles;
    for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
      const auto& [i, j, k] = triangles[t];
      visit(id, t, state.position(i), state.position(j), state.position(k));
    }
  }
}

/// Möller and Trumbore, Fast, Minimum Storage Ray/Triangle Intersection, Journal of Graphics Tools 2(1), 1997.
std::optional<SurfacePoint> intersect(const engine::Vec3& origin, const engine::Vec3& direction,
                                      const engine::Vec3& a, const engine::Vec3& b, const engine::Vec3& c) {
  const engine::Vec3 ab = b - a, ac = c - a, p = direction.cross(ac), to_origin = origin - a;
  const double determinant = ab.dot(p);
  if (determinant == 0) return {};
  const double u = to_origin.dot(p) / determinant;
  const engine::Vec3 q = to_origin.cross(ab);
  const double v = direction.dot(q) / determinant, distance = ac.dot(q) / determinant;
  if (!(u >= 0 && v >= 0 && u + v <= 1 && distance >= 0)) return {};
  SurfacePoint point;
  point.weights = {1 - u - v, u, v};
  point.distance = distance;
  return point;
}

void check_reach(double reach) {
  if (!(reach >= 0)) throw InputError("reach must be 0 m or more");
}

}  // namespace

std::optional<SurfacePoint> World::cast_ray(const Vec3& origin, const Vec3& direction, double reach) const {
  check_reach(reach);
  const engine::Vec3 from = to_engine(origin), along = to_engine(direction).normalized();
  if (!from.allFinite() || !along.allFinite() || along.norm() < 0.5)
    throw InputError("a ray requires a finite origin and a direction with a length above 0");
  std::optional<SurfacePoint> nearest;
  for_each_triangle(impl_->world,
                    [&](ClothId cloth, int triangle, const auto& a, const auto& b, const auto& c) {
                      std::optional<SurfacePoint> hit = intersect(from, along, a, b, c);
                      if (!hit || hit->distance > (nearest ? nearest->distance : reach)) return;
                      hit->cloth = cloth;
                      hit->triangle = triangle;
                      hit->position = engine::from_engine(engine::Vec3(from + hit->distance * along));
                      nearest = hit;
                    });
  return nearest;
}

std::optional<SurfacePoint> World::closest_point(const Vec3& point, double reach) const {
  check_reach(reach);
  const engine::Vec3 p = to_engine(point);
  if (!p.allFinite()) throw InputError("a point must be finite");
  std::optional<SurfacePoint> nearest;
  for_each_triangle(
      impl_->world, [&](ClothId cloth, int triangle, const auto& a, const auto& b, const auto& c) {
        const engine::PointTriangleDistance found = engine::point_triangle_distance(p, a, b, c);
        const double distance = found.distance();
        if (!(distance <= reach) || (nearest && distance >= nearest->distance)) return;
        nearest = SurfacePoint{cloth, triangle, engine::from_engine(found.weights),
                               engine::from_engine(engine::point_at(found.weights, a, b, c)), distance};
      });
  return nearest;
}

}  // namespace weft
