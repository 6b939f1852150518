#pragma once
/// Colliders: solid bodies that are fixed, move along key frames, or are moved by the program.

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "weft/export.h"
#include "weft/mesh.h"
#include "weft/vec.h"

namespace weft::engine {
class SkinnedMesh;
}

namespace weft {

struct Sphere {
  Vec3 center = {};   // [m]
  double radius = 1;  // > 0 [m]
};

/// Half space below a plane, solid: { p : (p − point) · normal < 0 }.
struct Plane {
  Vec3 point = {};          // [m]
  Vec3 normal = {0, 1, 0};  // length 1 [1]
};

/// All points within `radius` of the segment a–b; a = b is a sphere.
struct Capsule {
  Vec3 a = {};          // [m]
  Vec3 b = {0, 1, 0};   // [m]
  double radius = 0.5;  // > 0 [m]
};

struct OrientedBox {
  Vec3 center = {};                  // [m]
  Vec3 half_size = {0.5, 0.5, 0.5};  // along its own axes, > 0 [m]
  Mat3 rotation = {};                // its columns are the box's axes [1]
};

/// Displacement from the initial pose at a time: a rotation by `angles_deg` about the body's pivot, then a
/// translation. Linear between frames, constant outside them; angles count full turns.
struct KeyFrame {
  double time = 0;        // [s]
  Vec3 translation = {};  // [m]
  Vec3 angles_deg = {};   // about fixed x, then y, then z [degrees]
};

/// Vertex positions of a mesh at a time, in the mesh's own coordinates; linear between frames.
struct MeshFrame {
  double time = 0;                   // [s]
  std::vector<Vec3> positions = {};  // (num_vertices) [m]
};

/// Vertices of a mesh as a function of time: the skins, morph targets and nodes of a glTF file (read_gltf).
/// Copies share the data.
class WEFT_API VertexMotion {
 public:
  bool is_empty() const { return source_ == nullptr; }
  int num_vertices() const;                        // 0 if it is empty
  double start() const;                            // first key [s]
  double end() const;                              // last key [s]
  std::vector<Vec3> positions(double time) const;  // (num_vertices) constant before start and after end [m]

 private:
  friend struct VertexMotionAccess;  // library internals
  std::shared_ptr<const engine::SkinnedMesh> source_;
};

struct ColliderDesc {
  std::string name = {};  // for reports; empty: "collider", "collider 2", …

  /// In its own coordinates. Closed shells of a mesh are solid and should face outwards; triangles and shells
  /// that face inwards are flipped. Open shells collide on both sides. Coincident vertices are merged;
  /// degenerate and duplicate triangles are dropped.
  std::variant<Sphere, Plane, Capsule, OrientedBox, TriangleMesh> shape = {};
  std::string source = {};  // file of a mesh, for messages: "body.obj"; may be empty

  /// Whether the holes of a mesh's shells are filled, which makes them solid. Empty: of shells whose holes are
  /// at most a twentieth of their area.
  std::optional<bool> solid = {};

  Pose pose = {};                      // initial pose, from the shape's own coordinates to the world
  std::vector<KeyFrame> motion = {};   // pivot: centre, plane point, middle of the axis; of meshes the origin
  std::vector<MeshFrame> frames = {};  // of a deforming mesh; empty: rigid

  /// Another way to deform a mesh, evaluated in every step. Its vertices are the mesh's, in their order.
  VertexMotion deformation = {};
  double deformation_start = 0;  // time of `deformation` at time 0 of the world, and before [s]

  double friction = 0.3;       // Coulomb coefficient, >= 0 [1]
  double static_friction = 0;  // while nothing slides; below `friction`: as `friction` [1]
};

}  // namespace weft
