#include "weft/contact/shape_clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace weft::engine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// How far the distance of any point from the one shape can differ from that from the other [m].
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

}  // namespace

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
