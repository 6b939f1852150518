#include "weft/run/frame_checks.h"

#include <algorithm>
#include <cstdio>

#include "weft/mesh/soup.h"
#include "weft/verify/passages.h"

namespace weft::engine {
namespace {

using verify::MeshView;
using verify::Solid;

/// p ↦ rotation p + translation.
struct Placement {
  Mat3 rotation;
  Vec3 translation;

  Vec3 point(const Vec3& p) const { return rotation * p + translation; }

  Solid operator()(const Sphere& s) const { return Sphere{point(s.center), s.radius}; }
  Solid operator()(const Plane& p) const { return Plane{point(p.point), rotation * p.normal}; }
  Solid operator()(const Capsule& c) const { return Capsule{point(c.a), point(c.b), c.radius}; }
  Solid operator()(const OrientedBox& b) const {
    return OrientedBox{point(b.center), b.half_size, rotation * b.rotation};
  }
};

/// A mesh whose positions are stored in `result`.
MeshView view_mesh(std::vector<Vec3> positions, const std::vector<Triangle>& triangles,
                   const std::vector<Triangle>& solid, FrameToCheck& result) {
  return {result.positions.emplace_back(std::move(positions)), triangles, solid};
}

/// The mesh in its placement.
MeshView place_mesh(std::vector<Vec3> positions, const std::vector<Triangle>& triangles,
                    const std::vector<Triangle>& solid, const Placement& placement, FrameToCheck& result) {
  for (Vec3& p : positions) p = placement.point(p);
  return view_mesh(std::move(positions), triangles, solid, result);
}

std::vector<Vec3> positions_of(const MeshShape& shape) {
  std::vector<Vec3> positions;
  for (int v = 0; v < shape.mesh->num_vertices(); ++v) positions.push_back(shape.vertex(v));
  return positions;
}

Solid place(const ColliderShape& shape, const std::vector<Triangle>& solid, FrameToCheck& result) {
  if (const auto* mesh = std::get_if<MeshShape>(&shape)) {
    return view_mesh(positions_of(*mesh), mesh->mesh->triangles, solid, result);
  }
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return *sphere;
  if (const auto* plane = std::get_if<Plane>(&shape)) return *plane;
  if (const auto* capsule = std::get_if<Capsule>(&shape)) return *capsule;
  return std::get<OrientedBox>(shape);
}

std::vector<Vec3> to_positions(const std::vector<float>& coordinates) {
  std::vector<Vec3> positions(coordinates.size() / 3);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    positions[i] = Eigen::Map<const Eigen::Vector3f>(&coordinates[3 * i]).cast<double>();
  }
  return positions;
}

void add_cloth(const std::string& name, const std::vector<Triangle>& triangles, std::vector<Vec3> positions,
               FrameToCheck& result) {
  result.positions.push_back(std::move(positions));
  result.frame.cloths.push_back({name, result.positions.back(), triangles});
}

std::string millimetres(double length) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g mm", 1000 * length);
  return text;
}

/// Adds the check of one frame to the results.
void add_frame(const verify::Frame& frame, int index, const AnimationCheckOptions& options,
               AnimationCheck& sum) {
  const verify::FrameCheck check = verify::check_frame(frame, 1);
  const auto add_offence = [&](const std::string& what) {
    sum.is_clean = false;
    if (static_cast<int>(sum.offences.size()) < options.num_offences) sum.offences.push_back({index, what});
  };
  ++sum.frames;
  if (check.intersections > 0) {
    ++sum.frames_with_crossings;
    const int more = check.intersections - 1;
    const std::string others = more > 0 ? " (and " + std::to_string(more) + " more)" : "";
    add_offence(verify::describe(frame, check.first[0]) + others);
  }
  if (check.intersections > sum.intersections) {
    sum.intersections = check.intersections;
    sum.worst_frame = index;
  }
  if (!check.deepest) return;
  const std::string place = verify::describe(frame, *check.deepest);
  if (check.penetration() > options.tolerance)
    add_offence(place + ", " + millimetres(check.penetration()) + " deep");
  if (check.penetration() > sum.penetration_max.value_or(0)) {
    sum.deepest_frame = index;
    sum.deepest_place = place;
  }
  sum.penetration_max = std::max(sum.penetration_max.value_or(0), check.penetration());
}

void add_passages(const std::vector<verify::FeaturePair>& passages, const verify::Frame& frame, int index,
                  const AnimationCheckOptions& options, AnimationCheck& sum) {
  if (passages.empty()) return;
  sum.passages += static_cast<int>(passages.size());
  const std::size_t more = passages.size() - 1;
  const std::string others = more > 0 ? " (and " + std::to_string(more) + " more)" : "";
  if (static_cast<int>(sum.possible_passages.size()) < options.num_offences)
    sum.possible_passages.push_back({index, verify::describe(frame, passages[0]) + others});
  if (options.passages_offend) sum.is_clean = false;
}

/// Frames of an animation, whose meshes must outlive this.
class AnimationFrames {
 public:
  explicit AnimationFrames(const Animation& meshes) : meshes_(meshes) {
    std::vector<std::vector<Triangle>> solid;
    for (const AnimatedBody& body : meshes.bodies)
      solid.push_back(body.shape ? std::vector<Triangle>()
                                 : verify::find_solid_triangles(body.mesh.triangles));
    solid_ = std::make_shared<const std::vector<std::vector<Triangle>>>(std::move(solid));
  }

  FrameToCheck at(const AnimationFrame& frame) const {
    FrameToCheck result;
    result.solid = solid_;
    for (std::size_t c = 0; c < meshes_.cloths.size(); ++c) {
      const AnimatedCloth& cloth = meshes_.cloths[c];
      const bool tears = is_soup(cloth.triangles);
      if (tears) result.joined.push_back(join_soup(cloth.triangles, frame.cloths[c]));
      add_cloth(cloth.name, tears ? result.joined.back() : cloth.triangles, to_positions(frame.cloths[c]),
                result);
    }
    for (std::size_t b = 0; b < meshes_.bodies.size(); ++b) {
      const AnimatedBody& body = meshes_.bodies[b];
      const std::vector<float>& moved = frame.body_vertices[b];
      const Placement placement{frame.poses[b].rotation.toRotationMatrix(), frame.poses[b].translation};
      const Solid shape = body.shape
                              ? std::visit(placement, *body.shape)
                              : Solid(place_mesh(moved.empty() ? body.mesh.positions : to_positions(moved),
                                                 body.mesh.triangles, (*solid_)[b], placement, result));
      result.frame.colliders.push_back({body.name, shape, placement.rotation});
    }
    result.frame.non_colliding = meshes_.passing;
    return result;
  }

 private:
  const Animation& meshes_;
  std::shared_ptr<const std::vector<std::vector<Triangle>>> solid_;  // see FrameToCheck
};

}  // namespace

WorldFrames::WorldFrames(const World& world) : world_(world) {
  std::vector<std::vector<Triangle>> solid;
  for (const Collider& collider : world.colliders()) {
    const auto* mesh = std::get_if<MeshShape>(&collider.shape);
    solid.push_back(mesh ? verify::find_solid_triangles(mesh->mesh->triangles) : std::vector<Triangle>());
  }
  solid_ = std::make_shared<const std::vector<std::vector<Triangle>>>(std::move(solid));
}

FrameToCheck WorldFrames::at(double time) const {
  FrameToCheck result;
  result.solid = solid_;
  for (int c = 0; c < world_.num_cloths(); ++c) {
    add_cloth(world_.name(world_.cloth(c)), world_.model(world_.cloth(c)).topology->mesh.triangles,
              positions_of(world_.state(world_.cloth(c))), result);
  }
  for (std::size_t k = 0; k < world_.colliders().size(); ++k) {
    const Collider& collider = world_.colliders()[k];
    const Solid shape = place(shape_at(collider, time), (*solid_)[k], result);
    result.frame.colliders.push_back({collider.name, shape, collider.motion.at(time).rotation});
  }
  result.frame.non_colliding = world_.non_colliding_pairs();
  return result;
}

std::optional<StepWarning> find_inside(const verify::Frame& frame,
                                       const std::optional<verify::Penetration>& deepest) {
  if (!deepest || deepest->depth <= AnimationCheckOptions{}.tolerance) return std::nullopt;
  const int particle = deepest->particle < 0 ? frame.cloths[deepest->cloth].triangles[deepest->triangle][0]
                                             : deepest->particle;
  return StepWarning{.code = WarningCode::penetration,
                     .cloth = deepest->cloth,
                     .particle = particle,
                     .value = deepest->depth,
                     .collider = deepest->solid};
}

FrameFindings check_frame(const Animation& meshes, const AnimationFrame& frame, int num_places) {
  const FrameToCheck checked = AnimationFrames(meshes).at(frame);
  const verify::FrameCheck check = verify::check_frame(checked.frame, num_places);
  FrameFindings findings{.intersections = check.intersections,
                         .sentences = verify::describe_by_surfaces(checked.frame, check.first)};
  for (const verify::Crossing& crossing : check.first) {
    const verify::NamedCloth& cloth = checked.frame.cloths[crossing.a.surface];
    const Triangle& t = cloth.triangles[crossing.a.triangle];
    findings.places.push_back((cloth.positions[t[0]] + cloth.positions[t[1]] + cloth.positions[t[2]]) / 3);
  }
  if (!check.deepest) return findings;
  findings.penetration = check.penetration();
  findings.deepest = verify::describe(checked.frame, *check.deepest);
  return findings;
}

AnimationCheck check_animation(FrameSource& animation, const AnimationCheckOptions& options) {
  const AnimationFrames frames(animation.meshes());
  AnimationCheck sum;
  std::optional<verify::PassageWatch> watch;
  for (int k = 0; k < animation.num_frames(); ++k) {
    const FrameToCheck frame = frames.at(animation.read(k));
    add_frame(frame.frame, k, options, sum);
    if (watch) {
      add_passages(watch->advance(frame.frame), frame.frame, k, options, sum);
    } else {
      watch.emplace(frame.frame, options.tolerance);
    }
  }
  return sum;
}

}  // namespace weft::engine
