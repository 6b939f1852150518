#include "weft/render/pick.h"

#include <cmath>
#include <limits>

#include "weft/geometry/aabb_tree.h"

namespace weft::engine {
namespace {

/// Intersection of a ray with a triangle (Möller and Trumbore 1997).
struct Meeting {
  double t;
  Vec3 weights;
};

std::optional<Meeting> meet(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, p = ray.direction.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant == 0) return std::nullopt;
  const Vec3 s = ray.origin - a, q = s.cross(ab);
  const double u = s.dot(p) / determinant, v = ray.direction.dot(q) / determinant,
               t = ac.dot(q) / determinant;
  if (u < 0 || v < 0 || u + v > 1 || t < 0) return std::nullopt;
  return Meeting{t, {1 - u - v, u, v}};
}

std::optional<Hit> find_in_mesh(const DrawnMesh& mesh, const Ray& ray, JobSystem& jobs) {
  const auto place = [&](int v) -> Vec3 {
    return Eigen::Map<const Eigen::Vector3f>(mesh.positions.data() + 3 * v).cast<double>();
  };
  std::vector<Aabb> boxes(mesh.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    for (const int v : mesh.triangles[t]) {
      const float* p = mesh.positions.data() + 3 * v;
      boxes[t].merge({{p[0], p[1], p[2]}, {p[0], p[1], p[2]}});
    }
  }
  AabbTree tree;
  tree.build(boxes, {}, jobs);
  std::optional<Hit> hit;
  double nearest = std::numeric_limits<double>::infinity();
  tree.for_each_along_ray(ray.origin, ray.direction, 1e30, [&](int item) {
    const auto& [a, b, c] = mesh.triangles[item];
    const auto meeting = meet(ray, place(a), place(b), place(c));
    const bool is_first = hit && meeting && meeting->t == nearest && item < hit->triangle;
    if (meeting && (meeting->t < nearest || is_first)) {
      nearest = meeting->t;
      hit = Hit{.triangle = item,
                .weights = meeting->weights,
                .point = ray.origin + meeting->t * ray.direction,
                .distance = meeting->t};
    }
    return nearest;
  });
  return hit;
}

}  // namespace

std::optional<Hit> find_first_hit(std::span<const DrawnMesh> meshes, const Ray& ray) {
  const auto jobs = make_serial_jobs();
  std::optional<Hit> first;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    std::optional<Hit> hit = find_in_mesh(meshes[m], ray, *jobs);
    if (!hit || (first && first->distance <= hit->distance)) continue;
    hit->mesh = static_cast<int>(m);
    first = hit;
  }
  return first;
}

}  // namespace weft::engine
