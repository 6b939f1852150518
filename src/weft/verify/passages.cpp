#include "weft/verify/passages.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "weft/verify/pair_motion.h"

namespace weft::engine::verify {
namespace {

constexpr double kListedReach = 0.5;  // range of the lists of near pairs, in mean edges of cloth

using Kind = FeaturePair::Kind;
using Bounds = Eigen::AlignedBox3d;

// ---- Shapes as surfaces: features deep inside, which no cloth may pass through ----

const std::vector<Triangle> kPoint = {{0, 0, 0}}, kSegment = {{0, 1, 1}};

/// Of the corners (±1, ±1, ±1): bit k of the index is the sign along axis k.
const std::vector<Triangle> kBox = {{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}};

struct FeaturesInside {
  double tolerance;  // depth of the features in boxes [m]

  std::vector<Vec3> operator()(const Sphere& s) const { return {s.center}; }
  std::vector<Vec3> operator()(const Capsule& c) const { return {c.a, c.b}; }
  std::vector<Vec3> operator()(const Plane&) const { return {}; }
  std::vector<Vec3> operator()(const MeshView& mesh) const {
    return {mesh.positions.begin(), mesh.positions.end()};
  }
  std::vector<Vec3> operator()(const OrientedBox& box) const {
    const Vec3 half = (box.half_size.array() - tolerance).max(0);
    std::vector<Vec3> corners;
    for (int k = 0; k < 8; ++k) {
      const Vec3 signs(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
      corners.push_back(box.center + box.rotation * signs.cwiseProduct(half));
    }
    return corners;
  }
};

MovingSurface surface_of(const Solid& solid) {
  if (const auto* mesh = std::get_if<MeshView>(&solid)) {
    return {{mesh->triangles.begin(), mesh->triangles.end()}, MovingSurface::Kind::body};
  }
  if (std::holds_alternative<Sphere>(solid)) return {kPoint, MovingSurface::Kind::frame};
  if (std::holds_alternative<Capsule>(solid)) return {kSegment, MovingSurface::Kind::frame};
  if (std::holds_alternative<OrientedBox>(solid)) return {kBox, MovingSurface::Kind::frame};
  return {{}, MovingSurface::Kind::frame};
}

std::vector<MovingSurface> surfaces_of(const Frame& frame) {
  std::vector<MovingSurface> surfaces;
  for (const NamedCloth& cloth : frame.cloths)
    surfaces.push_back({{cloth.triangles.begin(), cloth.triangles.end()}, MovingSurface::Kind::cloth});
  for (const NamedCollider& collider : frame.colliders) surfaces.push_back(surface_of(collider.shape));
  return surfaces;
}

double mean_edge(const Frame& frame) {
  double sum = 0, count = 0;
  for (const NamedCloth& cloth : frame.cloths) {
    for (const Triangle& t : cloth.triangles) {
      for (int k = 0; k < 3; ++k) sum += (cloth.positions[t[k]] - cloth.positions[t[(k + 1) % 3]]).norm();
      count += 3;
    }
  }
  return count > 0 ? sum / count : 0;
}

bool is_finite(const std::vector<Vec3>& positions) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : positions) sum += 0.0 * p;
  return sum == Vec3::Zero();
}

// ---- Features ----

PointMotion motion_of(const MovingSurface& surface, int vertex) {
  return {surface.start[vertex], surface.end[vertex]};
}

PairMotion test(const std::vector<MovingSurface>& surfaces, const FeaturePair& pair) {
  const MovingSurface &surface = surfaces[pair.surface], &other = surfaces[pair.other];
  const auto [i, j] = pair.feature;
  if (pair.kind == Kind::vertex_triangle) {
    const auto& [a, b, c] = other.triangles[pair.opposite[0]];
    return test_vertex_triangle(motion_of(surface, i),
                                {motion_of(other, a), motion_of(other, b), motion_of(other, c)});
  }
  const auto [k, l] = pair.opposite;
  return test_edge_edge({motion_of(surface, i), motion_of(surface, j)},
                        {motion_of(other, k), motion_of(other, l)});
}

// ---- Particles and shapes ----

struct Placement {
  Mat3 rotation;
  Vec3 origin;

  Vec3 local(const Vec3& p) const { return rotation.transpose() * (p - origin); }
};

/// A frame of reference in which a shape is at rest.
struct RestFrame {
  Placement before, after;
  Solid shape;  // in that frame
};

struct RestFrames {
  const NamedCollider &before, &after;

  std::vector<RestFrame> operator()(const Sphere& s) const {
    const Sphere at_origin{Vec3::Zero(), s.radius};
    return add_turned(at_origin,
                      {{{Mat3::Identity(), s.center}, {Mat3::Identity(), next(s).center}, at_origin}});
  }

  /// The frame that does not rotate about the axis, and the one that rotates with the body.
  std::vector<RestFrame> operator()(const Capsule& c) const {
    const Capsule& to = next(c);
    const Vec3 axis = c.b - c.a, middle = 0.5 * (c.a + c.b), to_middle = 0.5 * (to.a + to.b);
    const Mat3 turn = Eigen::Quaterniond::FromTwoVectors(axis, to.b - to.a).toRotationMatrix();
    const Capsule at_origin{-0.5 * axis, 0.5 * axis, c.radius};
    return add_turned(at_origin, {{{Mat3::Identity(), middle}, {turn, to_middle}, at_origin}});
  }

  std::vector<RestFrame> operator()(const OrientedBox& box) const {
    const OrientedBox& to = next(box);
    return {{{box.rotation, box.center},
             {to.rotation, to.center},
             OrientedBox{Vec3::Zero(), box.half_size, Mat3::Identity()}}};
  }

  std::vector<RestFrame> operator()(const Plane&) const { return {}; }
  std::vector<RestFrame> operator()(const MeshView&) const { return {}; }

 private:
  template <class Shape>
  const Shape& next(const Shape&) const {
    return std::get<Shape>(after.shape);
  }

  std::vector<RestFrame> add_turned(const Solid& at_origin, std::vector<RestFrame> frames) const {
    if (!before.rotation || !after.rotation) return frames;
    const auto& [from, to, shape] = frames[0];
    frames.push_back({from, {*after.rotation * before.rotation->transpose(), to.origin}, at_origin});
    return frames;
  }
};

/// Depth of the deepest point of a path; not positive if the path stays outside.
double depth_on(const Vec3& from, const Vec3& to, const Solid& solid) {
  const auto depth = [&](const auto& shape) {
    if constexpr (std::is_same_v<decltype(shape), const MeshView&>) {
      return 0.0;
    } else {
      return depth_in(shape, Corners{from, to, to});
    }
  };
  return std::visit(depth, solid);
}

/// Depth in every rest frame of the shape.
double depth_on(const PointMotion& way, const std::vector<RestFrame>& frames) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [before, after, shape] : frames)
    least = std::min(least, depth_on(before.local(way.start), after.local(way.end), shape));
  return least;
}

/// Depth at a point, in the first of the frames: they differ only by rotations under which the shape is
/// symmetric.
double depth_at(const Vec3& p, const Placement& placement, const Solid& shape) {
  const Vec3 local = placement.local(p);
  return depth_on(local, local, shape);
}

Bounds bounds_of_motion(const Solid& before, const Solid& after) {
  const auto bounds = [](const auto& shape) -> Bounds {
    if constexpr (std::is_same_v<decltype(shape), const MeshView&>) {
      return {};
    } else {
      return bounds_of(shape);
    }
  };
  return std::visit(bounds, before).merged(std::visit(bounds, after));
}

// ---- Names ----

bool is_non_colliding(const Frame& frame, const std::string& a, const std::string& b) {
  return std::any_of(frame.non_colliding.begin(), frame.non_colliding.end(), [&](const auto& pair) {
    return (pair[0] == a && pair[1] == b) || (pair[0] == b && pair[1] == a);
  });
}

const std::string& name_of(const Frame& frame, int surface) {
  const auto num_cloths = static_cast<int>(frame.cloths.size());
  return surface < num_cloths ? frame.cloths[surface].name : frame.colliders[surface - num_cloths].name;
}

}  // namespace

PassageWatch::PassageWatch(const Frame& start, double tolerance)
    : tolerance_(tolerance),
      surfaces_(surfaces_of(start)),
      pairs_(static_cast<int>(surfaces_.size()), kListedReach * mean_edge(start)) {
  read(start);
  for (MovingSurface& surface : surfaces_) surface.start = surface.end;
  colliders_ = start.colliders;
}

/// Reads the end positions of the motion.
void PassageWatch::read(const Frame& frame) {
  std::size_t s = 0;
  for (const NamedCloth& cloth : frame.cloths)
    surfaces_[s++].end.assign(cloth.positions.begin(), cloth.positions.end());
  for (const NamedCollider& collider : frame.colliders)
    surfaces_[s++].end = std::visit(FeaturesInside{tolerance_}, collider.shape);
}

bool PassageWatch::fits(const Frame& frame) const {
  for (std::size_t c = 0; c < frame.cloths.size(); ++c) {
    if (!std::ranges::equal(frame.cloths[c].triangles, surfaces_[c].triangles)) return false;
  }
  return true;
}

std::vector<FeaturePair> PassageWatch::advance(const Frame& next) {
  if (!fits(next)) {
    const int num_left_out = pending_.num_left_out;
    *this = PassageWatch(next, tolerance_);
    pending_.num_left_out = num_left_out;
    return {};
  }
  read(next);
  for (const MovingSurface& surface : surfaces_) {
    if (is_finite(surface.end)) continue;
    ++pending_.num_left_out;
    return {};
  }
  test_features(next);
  for (int c = 0; c < static_cast<int>(next.cloths.size()); ++c) {
    for (int k = 0; k < static_cast<int>(next.colliders.size()); ++k) test_particles(next, c, k);
  }
  for (MovingSurface& surface : surfaces_) surface.start.swap(surface.end);
  colliders_ = next.colliders;
  pending_.open = std::move(still_open_);
  still_open_.clear();
  std::sort(passages_.begin(), passages_.end());
  return std::exchange(passages_, {});
}

void PassageWatch::test_features(const Frame& next) {
  const auto may_meet = [&](int a, int b) {
    if (!surfaces_[a].is_cloth && !surfaces_[b].is_cloth) return false;
    return !is_non_colliding(next, name_of(next, a), name_of(next, b));
  };
  const bool is_done = pairs_.for_each(surfaces_, may_meet, [&](const FeaturePair& pair) {
    const auto [passes, is_open_before, is_open_after] = test(surfaces_, pair);
    settle(pair, passes, is_open_before, is_open_after);
  });
  if (!is_done) ++pending_.num_left_out;
}

void PassageWatch::test_particles(const Frame& next, int cloth, int collider) {
  const NamedCollider &before = colliders_[collider], &after = next.colliders[collider];
  if (is_non_colliding(next, next.cloths[cloth].name, after.name)) return;
  const std::vector<RestFrame> frames = std::visit(RestFrames{before, after}, before.shape);
  if (frames.empty()) return;
  const Bounds bounds = bounds_of_motion(before.shape, after.shape);
  const bool is_turning =
      frames[0].before.rotation != frames[0].after.rotation;  // then paths are curved outside
  const MovingSurface& surface = surfaces_[cloth];
  const int collider_surface = static_cast<int>(next.cloths.size()) + collider;
  for (int i = 0; i < static_cast<int>(surface.end.size()); ++i) {
    const PointMotion way = motion_of(surface, i);
    if (!is_turning && !bounds.intersects(Bounds(way.start.cwiseMin(way.end), way.start.cwiseMax(way.end))))
      continue;
    if (depth_on(way, frames) <= tolerance_) continue;
    const FeaturePair pair{Kind::particle_shape, cloth, collider_surface, {i, i}, {-1, -1}};
    const bool is_in_before = depth_at(way.start, frames[0].before, frames[0].shape) > tolerance_;
    const bool is_in_after = depth_at(way.end, frames[0].after, frames[0].shape) > tolerance_;
    settle(pair, !is_in_before && !pending_.open.contains(pair), is_in_before, is_in_after);
  }
}

/// A pair is open while it touches, or a particle is in a shape; its result is reported when it is no longer
/// open.
void PassageWatch::settle(const FeaturePair& pair, bool passes, bool is_open_before, bool is_open_after) {
  const auto known = pending_.open.find(pair);
  Open state = known != pending_.open.end() ? known->second : Open{.is_known = !is_open_before};
  state.is_through ^= passes;
  if (is_open_after) {
    still_open_[pair] = state;
  } else if (state.is_through && state.is_known) {
    passages_.push_back(pair);
  }
}

std::string describe(const Frame& frame, const FeaturePair& passage) {
  const auto num_cloths = static_cast<int>(frame.cloths.size());
  const auto name = [&](int surface) {
    return (surface < num_cloths ? "cloth \"" : "collider \"") + name_of(frame, surface) + '"';
  };
  const auto has_numbers = [&](int surface) {
    return surface < num_cloths ||
           std::holds_alternative<MeshView>(frame.colliders[surface - num_cloths].shape);
  };
  const auto part = [&](int surface, const std::array<int, 2>& feature, const char* single) {
    if (!has_numbers(surface)) return std::string();
    if (feature[0] == feature[1]) return ' ' + std::string(single) + ' ' + std::to_string(feature[0]);
    return " edge " + std::to_string(feature[0]) + "-" + std::to_string(feature[1]);
  };
  const char* vertex = passage.surface < num_cloths ? "particle" : "vertex";
  const std::string other = passage.surface == passage.other ? "its" : name(passage.other);
  return name(passage.surface) + part(passage.surface, passage.feature, vertex) + " passes through " + other +
         part(passage.other, passage.opposite, "triangle");
}

}  // namespace weft::engine::verify
