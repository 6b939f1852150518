#pragma once
/// Animations out: binary glTF 2.0 (.glb), which browsers, Blender and most viewers open.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "weft/core/shapes.h"
#include "weft/core/staged_file.h"
#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// A mesh with a position per vertex and frame. In the file: the first frame as the mesh, every further frame
/// as a morph target (positions and normals), and one animation that blends linearly from frame to frame.
struct AnimatedMesh {
  std::string name;
  std::vector<Triangle> triangles;
  std::array<double, 3> color = {0.8, 0.8, 0.8};  // linear red, green, blue in [0, 1]
  std::vector<std::vector<float>> frames;         // (num_frames) of (num_vertices x 3), world space [m]
  std::vector<float> fabric_coordinates;  // (num_vertices x 2) along warp and weft at rest; empty: none [m]
};

/// A mesh that moves rigidly, or that deforms and moves: for each frame a pose, which takes it to the world.
/// One pose: it stands still. In the file a body's `frames` are morph targets, as a cloth's.
struct RigidMesh {
  struct Pose {
    Vec3 translation = Vec3::Zero();                               // [m]
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // unit
    bool operator==(const Pose& other) const {
      return translation == other.translation && rotation.coeffs() == other.rotation.coeffs();
    }
  };

  std::string name;
  TriangleMesh mesh;
  std::array<double, 3> color = {0.5, 0.5, 0.5};
  std::vector<Pose> poses;                 // (1 or num_frames)
  std::vector<std::vector<float>> frames;  // of a body that deforms: (num_frames) of (num_vertices x 3), in
                                           // the mesh's coordinates; empty: the mesh stays as it is [m]
  /// Where a vertex is in a frame, in the mesh's coordinates.
  Vec3 vertex(std::size_t v, std::size_t frame) const {
    if (frames.empty()) return mesh.positions[v];
    return Eigen::Map<const Eigen::Vector3f>(&frames[frame][3 * v]).cast<double>();
  }

  std::optional<SolidShape> shape;  // what `mesh` shows, exactly, in its coordinates; empty: just the mesh
};

struct Animation {
  std::string title;              // goes to the file's extras
  double frames_per_second = 60;  // > 0
  std::vector<AnimatedMesh> cloths;
  std::vector<RigidMesh> bodies;
  std::vector<std::array<std::string, 2>> passing = {};  // names of those that may go through each other
};

/// Writes the animation; materials are double-sided, fabric coordinates become texture coordinates in metres.
/// What glTF has no words for goes to the nodes' extras, as
/// `"weft": {"role": "cloth"}` or `{"role": "collider", "shape": "sphere", "center": [0, 0, 0], "radius":
/// 0.3}`; other shapes are `plane` (point, normal), `capsule` (a, b, radius), `box` (center, half_size,
/// rotation: nine numbers row by row) and `mesh`. The asset's extras hold `title` and `passing`. All meshes
/// have the same number of frames (>= 1). An earlier file is replaced whole or not at all. Throws InputError
/// if the file cannot be written, with the system's reason, and for an animation that no viewer could show:
/// without meshes, with unequal numbers of frames, or with coordinates that are not finite.
void write_glb(const std::filesystem::path& file, const Animation& animation);

/// The same up to finish(): replace() is left to the caller.
void write_glb(StagedFile& file, const Animation& animation);

}  // namespace weft::engine
