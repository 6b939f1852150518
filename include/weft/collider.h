#pragma once
/// Solid bodies that cloth collides with, each still, moving along key frames, or moved by the program.

#include <string>
#include <variant>
#include <vector>

#include "weft/mesh.h"
#include "weft/vec.h"

namespace weft {

struct Sphere {
  Vec3 center = {};   // [m]
  double radius = 1;  // > 0 [m]
};

/// The half space below the plane is solid: { p : (p − point) · normal < 0 }.
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

/// Displacement from where a thing was at the start, at a time: it turns by `angles_deg` about its pivot, then
/// moves by `translation`. Linear between frames, constant outside them; angles count full turns.
struct KeyFrame {
  double time = 0;        // [s]
  Vec3 translation = {};  // [m]
  Vec3 angles_deg = {};   // about fixed x, then y, then z [degrees]
};

/// Positions of a mesh's vertices at a time, in the mesh's own coordinates; linear between frames.
struct MeshFrame {
  double time = 0;                   // [s]
  std::vector<Vec3> positions = {};  // (num_vertices) [m]
};

struct ColliderDesc {
  std::string name = {};  // for reports; empty: "collider", "collider 2", …

  /// In its own coordinates. Meshes: closed ones should face outwards; shells that face inwards are turned.
  /// Open ones keep cloth off on both sides. Vertices
  /// that coincide become one, triangles without area and repeated ones are dropped.
  std::variant<Sphere, Plane, Capsule, OrientedBox, TriangleMesh> shape = {};
  std::string source = {};  // where a mesh is from, for messages: "body.obj"; may be empty

  Pose pose = {};  // at the start, from the shape's own coordinates to the world
  std::vector<KeyFrame> motion =
      {};  // about the pivot: centre, point, middle of the axis; of meshes the origin
  std::vector<MeshFrame> frames = {};  // of a mesh that deforms; empty: it keeps its shape
  double friction = 0.3;               // Coulomb's coefficient, >= 0 [1]
  double static_friction = 0;          // while nothing slides; less than `friction`: the same [1]
};

}  // namespace weft
