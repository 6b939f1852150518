#include "weft/run/film.h"

#include <algorithm>

#include "weft/mesh/soup.h"
#include "weft/run/scene_run.h"

namespace weft::engine {
namespace {

constexpr double kPlaneSide = 4;  // of the square that shows a plane [m]
constexpr int kSphereRings = 32;

/// The collider's shape around its own pivot, exact and as a mesh for drawing.
AnimatedBody show(const Collider& collider) {
  AnimatedBody body;
  body.name = collider.name;
  if (const Sphere* sphere = std::get_if<Sphere>(&collider.shape)) {
    body.shape = Sphere{Vec3::Zero(), sphere->radius};
    body.mesh = make_sphere_mesh(Vec3::Zero(), sphere->radius, kSphereRings);
  } else if (const Plane* plane = std::get_if<Plane>(&collider.shape)) {
    body.shape = Plane{Vec3::Zero(), plane->normal};
    body.mesh = make_square_mesh(Vec3::Zero(), plane->normal, kPlaneSide);
  } else if (const Capsule* capsule = std::get_if<Capsule>(&collider.shape)) {
    const Vec3 half = 0.5 * (capsule->b - capsule->a);
    body.shape = Capsule{-half, half, capsule->radius};
    body.mesh = make_capsule_mesh(-half, half, capsule->radius, kSphereRings);
  } else if (const OrientedBox* box = std::get_if<OrientedBox>(&collider.shape)) {
    body.shape = OrientedBox{Vec3::Zero(), box->half_size, box->rotation};
    body.mesh = make_box_mesh(Vec3::Zero(), box->half_size, box->rotation);
  } else if (const MeshShape* shape = std::get_if<MeshShape>(&collider.shape)) {
    body.mesh = *shape->mesh;
    for (int v = 0; v < body.mesh.num_vertices(); ++v)
      body.mesh.positions[v] = shape->vertex(v) - shape->translation;
  }
  return body;
}

/// A deforming collider's vertices at a time, around its pivot and before its motion.
std::vector<float> positions(const MeshShape& shape, double time) {
  const MeshShape now = shape.at(time);
  std::vector<float> values;
  for (int v = 0; v < shape.mesh->num_vertices(); ++v) {
    for (const double c : Vec3(now.vertex(v) - shape.translation)) values.push_back(static_cast<float>(c));
  }
  return values;
}

std::vector<float> positions(const ClothState& state) {
  std::vector<float> values;
  values.reserve(3 * state.x.size());
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    for (const double c : state.position(i)) values.push_back(static_cast<float>(c));
  }
  return values;
}

/// Numbers of vertices, `width` each, as those of the triangles' corners.
std::vector<float> of_corners(const std::vector<Triangle>& triangles, int width,
                              const std::vector<float>& of_vertices) {
  std::vector<float> result;
  for (const Triangle& t : triangles) {
    for (const int v : t) {
      for (int n = 0; n < width; ++n) result.push_back(of_vertices[static_cast<std::size_t>(v) * width + n]);
    }
  }
  return result;
}

std::vector<float> make_soup_coordinates(const ClothTopology& whole) {
  return of_corners(whole.mesh.triangles, 2, make_fabric_coordinates(whole));
}

}  // namespace

std::vector<float> make_fabric_coordinates(const ClothTopology& topology) {
  std::array<int, 2> axes = {0, 2};
  if (!topology.grid) {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : topology.mesh.positions) box.extend(p);
    int shortest = 0;
    box.sizes().minCoeff(&shortest);
    axes = {shortest == 0 ? 1 : 0, shortest == 2 ? 1 : 2};
  }
  std::vector<float> coordinates;
  for (const Vec3& p : topology.mesh.positions) {
    for (const int axis : axes) coordinates.push_back(static_cast<float>(p[axis]));
  }
  return coordinates;
}

Animation make_animation(const World& world, TornCloth torn) {
  Animation animation{.title = {}, .cloths = {}, .bodies = {}, .passing = world.non_colliding_pairs()};
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothTopology& topology = *world.model(world.cloth(c)).topology;
    AnimatedCloth mesh;
    mesh.name = world.name(world.cloth(c));
    const bool is_soup = torn == TornCloth::soup && world.can_tear(world.cloth(c));
    mesh.triangles = is_soup ? make_soup(topology.mesh.num_triangles()) : topology.mesh.triangles;
    mesh.color = ClothSceneDesc().color;
    mesh.fabric_coordinates = is_soup ? make_soup_coordinates(world.whole_topology(world.cloth(c)))
                                      : make_fabric_coordinates(topology);
    animation.cloths.push_back(std::move(mesh));
  }
  for (const Collider& collider : world.colliders()) animation.bodies.push_back(show(collider));
  return animation;
}

Animation make_animation(const SceneDesc& scene, const World& world, TornCloth torn) {
  Animation animation = make_animation(world, torn);
  animation.title = scene.name;
  animation.frames_per_second = scene.fps;
  for (std::size_t c = 0; c < animation.cloths.size(); ++c) {
    animation.cloths[c].color = scene.cloths[c].color;
    if (scene.cloths[c].fabric) animation.cloths[c].fabric = scene.cloths[c].fabric->name;
  }
  return animation;
}

AnimationFrame capture_frame(const World& world, TornCloth torn) {
  AnimationFrame frame;
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothId cloth = world.cloth(c);
    std::vector<float> own = positions(world.state(cloth));
    frame.cloths.push_back(torn == TornCloth::soup ? show(world, cloth, 3, std::move(own)) : std::move(own));
  }
  for (const Collider& collider : world.colliders()) {
    const MeshShape* mesh = std::get_if<MeshShape>(&collider.shape);
    frame.body_vertices.push_back(mesh && mesh->source ? positions(*mesh, world.time())
                                                       : std::vector<float>());
    const Pose pose = collider.motion.at(world.time());
    frame.poses.push_back({pivot(collider.shape) + pose.translation, Eigen::Quaterniond(pose.rotation)});
  }
  return frame;
}

std::vector<float> show(const World& world, ClothId cloth, int width, std::vector<float> of_particles) {
  if (!world.can_tear(cloth)) return of_particles;
  return of_corners(world.model(cloth).topology->mesh.triangles, width, of_particles);
}

void FilmSink::begin(SceneRun& run, RunReport&) {
  animation_ = make_animation(run.scene(), run.world());
  append_frame(capture_frame(run.world()), animation_);
}

void FilmSink::add_frame(const SceneRun& run, RunReport&) {
  append_frame(capture_frame(run.world()), animation_);
}

FilmSpool::FilmSpool(const std::filesystem::path& target, std::optional<ParticleValue> value)
    : value_(value), frames_(target) {}

void FilmSpool::begin(SceneRun& run, RunReport& report) {
  meshes_ = make_animation(run.scene(), run.world());
  if (value_ == ParticleValue::contact) run.world().track_contacts(true);
  add_frame(run, report);
}

void FilmSpool::add_frame(const SceneRun& run, RunReport&) {
  const World& world = run.world();
  AnimationFrame frame = capture_frame(world);
  for (int c = 0; value_ && c < world.num_cloths(); ++c)
    frame.values.push_back(show(world, world.cloth(c), 1, compute_values(*value_, world, world.cloth(c))));
  frames_.append(std::move(frame));
}

}  // namespace weft::engine
