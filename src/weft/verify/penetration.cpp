#include "weft/verify/penetration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "weft/verify/distance.h"
#include "weft/verify/inside.h"

namespace weft::engine::verify {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Bounds = Eigen::AlignedBox3d;

// ---- Boxes ----

/// A face of a box in its own coordinates: depth below it is half_size − sign · x[axis].
struct Face {
  int axis;
  double sign, half_size;

  double depth(const Vec3& p) const { return half_size - sign * p[axis]; }
};

using Faces = std::array<Face, 6>;

Faces faces_of(const Vec3& half_size) {
  Faces faces;
  for (int k = 0; k < 6; ++k) faces[k] = {k / 2, k % 2 == 0 ? 1.0 : -1.0, half_size[k / 2]};
  return faces;
}

double depth_in(const Faces& faces, const Vec3& p) {
  double least = kInfinity;
  for (const Face& face : faces) least = std::min(least, face.depth(p));
  return least;
}

/// Upper bound of the depth of any point of the triangle.
double bound_depth(const Faces& faces, const Corners& triangle) {
  double bound = kInfinity;
  for (const Face& face : faces) {
    bound = std::min(bound,
                     std::max({face.depth(triangle[0]), face.depth(triangle[1]), face.depth(triangle[2])}));
  }
  return bound;
}

/// A triangle clipped by five half spaces: each adds at most one corner.
struct Polygon {
  std::array<Vec3, 8> corners;
  int size = 0;

  void add(const Vec3& p) { corners[size++] = p; }
};

/// Clips to the part where the linear function `value` is not negative.
template <class Value>
Polygon clip(const Polygon& polygon, Value value) {
  Polygon kept;
  for (int i = 0; i < polygon.size; ++i) {
    const Vec3 &p = polygon.corners[i], &q = polygon.corners[(i + 1) % polygon.size];
    const double at_p = value(p), at_q = value(q);
    if (at_p >= 0) kept.add(p);
    if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) kept.add(p + at_p / (at_p - at_q) * (q - p));
  }
  return kept;
}

/// The part of the triangle that is nearer to this face's plane than to the other five.
Polygon part_nearest_to(const Face& nearest, const Faces& faces, const Corners& triangle) {
  Polygon part;
  for (const Vec3& p : triangle) part.add(p);
  for (const Face& other : faces) {
    if (other.axis == nearest.axis && other.sign == nearest.sign) continue;
    part = clip(part, [&](const Vec3& p) { return other.depth(p) - nearest.depth(p); });
  }
  return part;
}

/// Depth is linear over each face's part, so the greatest is at a corner of a part. Every corner is a point
/// of the triangle: rounding may slightly underestimate the depth, never overestimate it.
double greatest_depth(const Faces& faces, const Corners& triangle) {
  double deepest = -kInfinity;
  for (const Vec3& p : triangle) deepest = std::max(deepest, depth_in(faces, p));
  for (const Face& face : faces) {
    const Polygon part = part_nearest_to(face, faces, triangle);
    for (int i = 0; i < part.size; ++i) deepest = std::max(deepest, depth_in(faces, part.corners[i]));
  }
  return deepest;
}

// ---- All cloths, all solids ----

bool overlaps(const Bounds& bounds, const Corners& t) {
  const Vec3 low = t[0].cwiseMin(t[1]).cwiseMin(t[2]), high = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
  return (low.array() <= bounds.max().array()).all() && (high.array() >= bounds.min().array()).all();
}

/// Keeps the deepest point.
class Search {
 public:
  explicit Search(std::span<const SurfaceView> cloths) : cloths_(cloths) {}

  template <class Shape>
  void operator()(int solid, const Shape& shape) {
    const Bounds bounds = bounds_of(shape);
    for (std::size_t c = 0; c < cloths_.size(); ++c) {
      const SurfaceView& cloth = cloths_[c];
      for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
        const auto& [i, j, k] = cloth.triangles[t];
        const Corners corners = {cloth.positions[i], cloth.positions[j], cloth.positions[k]};
        if (!overlaps(bounds, corners)) continue;
        const double depth = verify::depth_in(shape, corners);
        if (depth > deepest_.depth) deepest_ = {depth, static_cast<int>(c), static_cast<int>(t), -1, solid};
      }
    }
    is_measured_ = true;
  }

  void operator()(int solid, const MeshView& mesh) {
    if (mesh.solid.empty()) return;
    const InsideOfMesh inside(mesh.positions, mesh.solid);
    DepthInMesh depth(mesh);
    for (std::size_t c = 0; c < cloths_.size(); ++c) {
      for (std::size_t i = 0; i < cloths_[c].positions.size(); ++i) {
        const Vec3& p = cloths_[c].positions[i];
        if (!inside.contains(p)) continue;
        const double d = depth.at(p, deepest_.depth);
        if (d > deepest_.depth) deepest_ = {d, static_cast<int>(c), -1, static_cast<int>(i), solid};
      }
    }
    is_measured_ = true;
  }

  std::optional<Penetration> result() const { return is_measured_ ? std::optional(deepest_) : std::nullopt; }

 private:
  /// Distance of interior points from a mesh's surface.
  class DepthInMesh {
   public:
    explicit DepthInMesh(const MeshView& mesh) : mesh_(mesh) {}

    /// The depth at p, or any number <= `known` if it is not greater than that. Neighbours tend to be near
    /// the same triangle, so the last nearest triangle is tested first.
    double at(const Vec3& p, double known) {
      double least = distance_sq(p, corners(nearest_));
      for (std::size_t t = 0; t < mesh_.solid.size() && least > known * known; ++t) {
        const double d = distance_sq(p, corners(t));
        if (d < least) std::tie(least, nearest_) = std::pair(d, t);
      }
      return std::sqrt(least);
    }

   private:
    Corners corners(std::size_t t) const {
      const auto& [a, b, c] = mesh_.solid[t];
      return {mesh_.positions[a], mesh_.positions[b], mesh_.positions[c]};
    }

    const MeshView& mesh_;
    std::size_t nearest_ = 0;
  };

  std::span<const SurfaceView> cloths_;
  Penetration deepest_;
  bool is_measured_ = false;
};

}  // namespace

Eigen::AlignedBox3d bounds_of(const Sphere& s) {
  return {s.center - Vec3::Constant(s.radius), s.center + Vec3::Constant(s.radius)};
}

Eigen::AlignedBox3d bounds_of(const Plane&) {
  return {Vec3::Constant(-kInfinity), Vec3::Constant(kInfinity)};
}

Eigen::AlignedBox3d bounds_of(const Capsule& c) {
  return {c.a.cwiseMin(c.b) - Vec3::Constant(c.radius), c.a.cwiseMax(c.b) + Vec3::Constant(c.radius)};
}

Eigen::AlignedBox3d bounds_of(const OrientedBox& box) {
  const Vec3 reach = box.rotation.cwiseAbs() * box.half_size;
  return {box.center - reach, box.center + reach};
}

double depth_in(const Sphere& sphere, const Corners& triangle) {
  return sphere.radius - std::sqrt(distance_sq(sphere.center, triangle));
}

double depth_in(const Plane& plane, const Corners& triangle) {
  double deepest = -kInfinity;
  for (const Vec3& p : triangle) deepest = std::max(deepest, (plane.point - p).dot(plane.normal));
  return deepest;
}

double depth_in(const Capsule& capsule, const Corners& triangle) {
  return capsule.radius - std::sqrt(distance_sq(Segment{capsule.a, capsule.b}, triangle));
}

double depth_in(const OrientedBox& box, const Corners& triangle) {
  Corners local;
  for (int k = 0; k < 3; ++k) local[k] = box.rotation.transpose() * (triangle[k] - box.center);
  const Faces faces = faces_of(box.half_size);
  const double bound = bound_depth(faces, local);
  return bound <= 0 ? bound : greatest_depth(faces, local);
}

std::vector<Triangle> find_solid_triangles(std::span<const Triangle> triangles) {
  struct Side {
    int low, high, triangle, direction;  // direction: 1 from the low to the high vertex, else -1
  };
  std::vector<Side> sides;
  std::vector<int> joined;  // each triangle to another one of its part, or to itself
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    joined.push_back(t);
    for (int k = 0; k < 3; ++k) {
      const int from = triangles[t][k], to = triangles[t][(k + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), t, from < to ? 1 : -1});
    }
  }
  const auto part_of = [&](int t) {
    while (joined[t] != t) t = joined[t] = joined[joined[t]];
    return t;
  };
  const auto edge_of = [](const Side& side) { return std::pair(side.low, side.high); };
  std::ranges::sort(sides, {}, edge_of);
  std::vector<std::span<const Side>> edges;
  for (auto begin = sides.begin(); begin != sides.end();) {
    const auto end =
        std::find_if(begin, sides.end(), [&](const Side& s) { return edge_of(s) != edge_of(*begin); });
    edges.emplace_back(begin, end);
    begin = end;
  }
  for (const std::span<const Side> edge : edges) {
    int excess = 0;
    for (const Side& side : edge) excess += side.direction;
    if (edge.size() > 2 && excess != 0) continue;
    for (const Side& side : edge) joined[part_of(side.triangle)] = part_of(edge[0].triangle);
  }
  std::vector<char> is_open(triangles.size(), 0);
  for (const std::span<const Side> edge : edges) {
    for (const Side& side : edge) {
      const int part = part_of(side.triangle);
      int excess = 0;  // of the edge in this part
      for (const Side& other : edge) excess += part_of(other.triangle) == part ? other.direction : 0;
      if (excess != 0) is_open[part] = 1;
    }
  }
  std::vector<Triangle> solid;
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    if (!is_open[part_of(t)]) solid.push_back(triangles[t]);
  }
  return solid;
}

std::optional<Penetration> find_deepest(std::span<const SurfaceView> cloths, std::span<const Solid> solids) {
  Search search(cloths);
  for (std::size_t s = 0; s < solids.size(); ++s) {
    std::visit([&](const auto& shape) { search(static_cast<int>(s), shape); }, solids[s]);
  }
  return search.result();
}

}  // namespace weft::engine::verify
