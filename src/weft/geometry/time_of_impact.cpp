#include "weft/geometry/time_of_impact.h"

#include <cmath>

#include "weft/geometry/distance.h"

namespace weft::engine {
namespace {

struct Corners {
  std::array<Vec3, 4> start, way;  // `way` without the common motion, which changes no distance

  Corners(const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to) : start(from) {
    Vec3 common = Vec3::Zero();
    for (int k = 0; k < 4; ++k) common += 0.25 * (to[k] - from[k]);
    for (int k = 0; k < 4; ++k) way[k] = to[k] - from[k] - common;
  }

  std::array<Vec3, 4> at(double time) const {
    std::array<Vec3, 4> x;
    for (int k = 0; k < 4; ++k) x[k] = start[k] + time * way[k];
    return x;
  }

  double travel(int k) const { return way[k].norm(); }
};

struct Closest {
  double distance;
  Vec3 offset;
  std::array<double, 4> weights;
};

Closest make_closest(const std::array<double, 4>& w, const std::array<Vec3, 4>& x) {
  const Vec3 offset = w[0] * x[0] + w[1] * x[1] + w[2] * x[2] + w[3] * x[3];
  return {offset.norm(), offset, w};
}

template <class At>
std::optional<Impact> find(const At& at, double travel, const ImpactLimit& limit) {
  const auto found = find_impact(at, travel, limit);
  if (!found) return std::nullopt;
  const Closest& closest = found->place;
  const Vec3 normal = closest.distance > 0 ? Vec3(closest.offset / closest.distance) : Vec3(Vec3::UnitY());
  return Impact{found->time, found->distance_before, normal, closest.weights};
}

}  // namespace

std::optional<Impact> find_vertex_triangle_impact(const std::array<Vec3, 4>& start,
                                                  const std::array<Vec3, 4>& end, const ImpactLimit& limit) {
  const Corners corners(start, end);
  const auto at = [&](double time) {
    const std::array<Vec3, 4> x = corners.at(time);
    const PointTriangleDistance d = point_triangle_distance(x[3], x[0], x[1], x[2]);
    return make_closest({-d.weights[0], -d.weights[1], -d.weights[2], 1}, x);
  };
  const double travel =
      corners.travel(3) + std::max({corners.travel(0), corners.travel(1), corners.travel(2)});
  return find(at, travel, limit);
}

std::optional<Impact> find_edge_edge_impact(const std::array<Vec3, 4>& start, const std::array<Vec3, 4>& end,
                                            const ImpactLimit& limit) {
  const Corners corners(start, end);
  const auto at = [&](double time) {
    const std::array<Vec3, 4> x = corners.at(time);
    const EdgeEdgeDistance d = edge_edge_distance(x[0], x[1], x[2], x[3]);
    return make_closest({1 - d.s, d.s, -(1 - d.t), -d.t}, x);
  };
  const double travel =
      std::max(corners.travel(0), corners.travel(1)) + std::max(corners.travel(2), corners.travel(3));
  return find(at, travel, limit);
}

}  // namespace weft::engine
