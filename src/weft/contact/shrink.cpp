#include "weft/contact/shrink.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "weft/geometry/aabb_tree.h"
#include "weft/geometry/distance.h"

namespace weft::engine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kGrain = 64;  // vertices per chunk of work

/// (num_vertices) area-weighted vertex normals of unit length.
std::vector<Vec3> compute_normals(const TriangleMesh& mesh) {
  std::vector<Vec3> normals(mesh.positions.size(), Vec3::Zero());
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 area = (mesh.positions[j] - mesh.positions[i]).cross(mesh.positions[k] - mesh.positions[i]);
    for (const int v : {i, j, k}) normals[v] += area;
  }
  for (Vec3& n : normals) n.stableNormalize();
  return normals;
}

/// Finds the opposite side of the solid.
class OtherSide {
 public:
  explicit OtherSide(const TriangleMesh& mesh) : mesh_(mesh) {
    std::vector<Aabb> boxes;
    for (const auto& [i, j, k] : mesh.triangles) {
      const Vec3 &a = mesh.positions[i], &b = mesh.positions[j], &c = mesh.positions[k];
      boxes.push_back(make_aabb(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)));
      facing_.push_back((b - a).cross(c - a).stableNormalized());
    }
    tree_.build(boxes, {}, *make_serial_jobs());
  }

  double inner_radius(const Vec3& p, const Vec3& normal, double most) const {
    constexpr int kMaxRounds = 20;
    constexpr double kEnough = 1e-3;  // relative change of the radius that ends the search
    double radius = most;
    for (int round = 0; round < kMaxRounds; ++round) {
      const Vec3 q = nearest(p - radius * normal, normal);
      const double along = normal.dot(p - q);
      if (!(along > 0)) break;
      const double next = (p - q).squaredNorm() / (2 * along);
      if (next > (1 - kEnough) * radius) break;
      radius = next;
    }
    return radius;
  }

 private:
  /// The nearest point on the triangles that do not face along `normal`.
  Vec3 nearest(const Vec3& c, const Vec3& normal) const {
    const auto distance_sq = [&](int t) {
      return facing_[t].dot(normal) > 0 ? kInfinity : to(t, c).distance_sq;
    };
    const int t = tree_.find_nearest(c, kInfinity, distance_sq);
    if (t < 0) return c + normal;
    const auto [i, j, k] = mesh_.triangles[t];
    return point_at(to(t, c).weights, mesh_.positions[i], mesh_.positions[j], mesh_.positions[k]);
  }

  PointTriangleDistance to(int t, const Vec3& p) const {
    const auto [i, j, k] = mesh_.triangles[t];
    return point_triangle_distance(p, mesh_.positions[i], mesh_.positions[j], mesh_.positions[k]);
  }

  const TriangleMesh& mesh_;
  std::vector<Vec3> facing_;  // (num_triangles)
  AabbTree tree_;
};

/// Replaces values by the means of themselves and their neighbours.
void smooth(const TriangleMesh& mesh, std::vector<Vec3>& values) {
  std::vector<Vec3> sums = values;
  std::vector<double> counts(values.size(), 1.0);
  for (const Triangle& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) {
      const int a = t[c], b = t[(c + 1) % 3];
      sums[a] += values[b];
      sums[b] += values[a];
      ++counts[a];
      ++counts[b];
    }
  }
  for (std::size_t v = 0; v < values.size(); ++v) values[v] = sums[v] / counts[v];
}

}  // namespace

std::vector<double> compute_inner_radii(const TriangleMesh& mesh, double most, JobSystem& jobs) {
  const std::vector<Vec3> normals = compute_normals(mesh);
  const OtherSide other_side(mesh);
  std::vector<double> radii(normals.size());
  parallel_for(jobs, mesh.num_vertices(), kGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) radii[v] = other_side.inner_radius(mesh.positions[v], normals[v], most);
  });
  return radii;
}

std::vector<Vec3> shrink(const TriangleMesh& mesh, const std::vector<double>& inner_radii, double depth) {
  constexpr int kSmoothings = 4;
  std::vector<Vec3> inwards = compute_normals(mesh);
  for (std::size_t v = 0; v < inwards.size(); ++v)
    inwards[v] *= -std::min(depth, kMaxShrinkage * inner_radii[v]);
  for (int pass = 0; pass < kSmoothings; ++pass) smooth(mesh, inwards);
  std::vector<Vec3> places;
  for (std::size_t v = 0; v < inwards.size(); ++v) places.push_back(mesh.positions[v] + inwards[v]);
  return places;
}

}  // namespace weft::engine
