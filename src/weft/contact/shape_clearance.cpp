#include "weft/contact/shape_clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "weft/geometry/shape_distance.h"

namespace weft::engine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The largest difference between any point's distances to the two shapes [m].
double difference(const Sphere& a, const Sphere& b) {
  return (a.center - b.center).norm() + std::abs(a.radius - b.radius);
}
double difference(const Plane& a, const Plane& b) {
  return a.normal == b.normal ? std::abs(a.normal.dot(b.point - a.point)) : kInfinity;
}
double difference(const Capsule& a, const Capsule& b) {
  return std::max((a.a - b.a).norm(), (a.b - b.b).norm()) + std::abs(a.radius - b.radius);
}
double difference(const OrientedBox& a, const OrientedBox& b) {
  return (a.center - b.center).norm() + (a.rotation - b.rotation).norm() * a.half_size.norm() +
         (a.half_size - b.half_size).norm();
}
template <class A, class B>
double difference(const A&, const B&) {
  return kInfinity;
}

double difference(const ColliderShape& a, const ColliderShape& b) {
  return std::visit([](const auto& x, const auto& y) { return difference(x, y); }, a, b);
}

/// Lower bound for the distance of the box to the shape [m].
double box_distance(const Sphere& s, const Vec3& min, const Vec3& max) {
  return (s.center - s.center.cwiseMax(min).cwiseMin(max)).norm() - s.radius;
}
double box_distance(const Plane& p, const Vec3& min, const Vec3& max) {
  return p.normal.dot(0.5 * (min + max) - p.point) - 0.5 * p.normal.cwiseAbs().dot(max - min);
}
double box_distance(const Capsule& c, const Vec3& min, const Vec3& max) {
  return boxes_distance(c.a.cwiseMin(c.b), c.a.cwiseMax(c.b), min, max) - c.radius;
}
double box_distance(const OrientedBox& b, const Vec3& min, const Vec3& max) {
  const Vec3 half = b.rotation.cwiseAbs() * b.half_size;
  return boxes_distance(b.center - half, b.center + half, min, max);
}
double box_distance(const MeshShape&, const Vec3&, const Vec3&) { return -kInfinity; }

}  // namespace

double least_distance(const MovingShape& shape, const Vec3& min, const Vec3& max) {
  const double at_end = std::visit([&](const auto& s) { return box_distance(s, min, max); }, shape.after);
  return at_end - difference(shape.before, shape.after);
}

double farthest_way(const SurfaceMotion& motion, int num_vertices) {
  double way_sq = 0;
  for (int v = 0; v < num_vertices; ++v) way_sq = farther_sq(way_sq, motion.end[v] - motion.start[v]);
  return std::sqrt(way_sq);
}

void ShapeClearance::begin_step(const std::vector<MovingShape>& shapes, int num_vertices, double travel) {
  rows_.resize(shapes.size());
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    if (shapes[s].is_mesh()) continue;
    Row& row = rows_[s];
    row.moved += travel + difference(row.at, shapes[s].before);
    row.move = difference(shapes[s].before, shapes[s].after);
    row.at = shapes[s].before;
    const bool is_known =
        std::isfinite(row.moved) && row.farther.size() == static_cast<std::size_t>(num_vertices);
    if (is_known) continue;
    row.moved = 0;
    row.farther.assign(num_vertices, -kInfinity);
  }
}

void ShapeClearance::find_near(int shape, double way, double reach, std::vector<int>& near) const {
  const Row& row = rows_[shape];
  const double farthest = row.moved + row.move + way + reach;
  near.clear();
  for (int v = 0; v < static_cast<int>(row.farther.size()); ++v) {
    if (!(row.farther[v] > farthest)) near.push_back(v);
  }
}

void ShapeClearance::set(int shape, int vertex, double distance, double way) {
  Row& row = rows_[shape];
  const double at_start = distance - way - row.move;
  row.farther[vertex] = std::isfinite(at_start) ? row.moved + at_start : -kInfinity;
}

}  // namespace weft::engine
