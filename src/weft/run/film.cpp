#include "weft/run/film.h"

#include <algorithm>

namespace weft::engine {
namespace {

constexpr double kPlaneSide = 4;  // of the square that shows a plane [m]
constexpr int kSphereRings = 32;

/// Where each particle lies along warp and weft before anything has moved: a grid's own axes, or the two axes
/// along which a mesh at rest is longest.
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

/// The collider's shape around its own pivot, exact and as a mesh to look at.
RigidMesh show(const Collider& collider) {
  RigidMesh body;
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
  MeshShape now = shape;
  now.blend = shape.sequence->at(time);
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

/// Of a mesh that has not been deformed yet.
std::vector<float> rest_positions(const TriangleMesh& mesh) {
  std::vector<float> values;
  for (const Vec3& p : mesh.positions) {
    for (const double c : p) values.push_back(static_cast<float>(c));
  }
  return values;
}

}  // namespace

Film::Film(const SceneDesc& scene, const World& world) : world_(world) {
  animation_.title = scene.name;
  animation_.frames_per_second = scene.fps;
  animation_.passing = world.passing_pairs();
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothTopology& topology = *world.model(world.cloth(c)).topology;
    AnimatedMesh mesh;
    mesh.name = world.name(world.cloth(c));
    mesh.triangles = topology.mesh.triangles;
    mesh.color = scene.cloths[c].color;
    mesh.fabric_coordinates = make_fabric_coordinates(topology);
    animation_.cloths.push_back(std::move(mesh));
  }
  for (const Collider& collider : world.colliders()) animation_.bodies.push_back(show(collider));
}

void Film::add_frame() {
  for (int c = 0; c < world_.num_cloths(); ++c)
    animation_.cloths[c].frames.push_back(positions(world_.state(world_.cloth(c))));
  const std::size_t num_before = num_frames_++;
  for (std::size_t b = 0; b < animation_.bodies.size(); ++b) {
    const Collider& collider = world_.colliders()[b];
    RigidMesh& body = animation_.bodies[b];
    const MeshShape* mesh = std::get_if<MeshShape>(&collider.shape);
    if (mesh && mesh->sequence) {
      body.frames.resize(num_before, rest_positions(body.mesh));
      body.frames.push_back(positions(*mesh, world_.time()));
    }
    const Pose pose = collider.motion.at(world_.time());
    const RigidMesh::Pose now{pivot(collider.shape) + pose.translation, Eigen::Quaterniond(pose.rotation)};
    if (body.poses.size() == 1 && body.poses[0] == now) continue;  // it has stood still so far
    if (!body.poses.empty()) body.poses.resize(num_before, body.poses[0]);
    body.poses.push_back(now);
  }
}

void Film::clear() {
  num_frames_ = 0;
  for (AnimatedMesh& cloth : animation_.cloths) cloth.frames.clear();
  for (RigidMesh& body : animation_.bodies) {
    body.poses.clear();
    body.frames.clear();
  }
}

}  // namespace weft::engine
