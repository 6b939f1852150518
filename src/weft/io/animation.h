#pragma once
/// Animations: meshes with their positions in every frame.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "weft/core/shapes.h"
#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// The vertices that files show of a cloth in place of its particles: first those of the user's mesh, in their
/// order. A vertex that has several texture coordinates is repeated behind them, as glTF has one for each.
struct ShownVertices {
  std::vector<int> particles;       // (num_shown) -1: none, the vertex is at rest
  std::vector<Triangle> triangles;  // (num_triangles) the cloth's, by shown vertices
  std::vector<float> rest;          // (num_shown x 3) in use without a particle [m]
  std::vector<float> texture;       // (num_shown x 2) u, v up; empty: none
};

/// A mesh with a position per vertex and frame.
struct AnimatedCloth {
  std::string name;
  std::vector<Triangle> triangles;
  std::array<double, 3> color = {0.8, 0.8, 0.8};  // linear red, green, blue in [0, 1]
  std::vector<std::vector<float>> frames;         // (num_frames) of (num_vertices x 3), world space [m]
  std::vector<float> fabric_coordinates;    // (num_vertices x 2) along warp and weft at rest; empty: none [m]
  std::optional<ShownVertices> shown = {};  // empty: its own
  std::string fabric = {};                  // its name; empty: none
};

/// A mesh that moves rigidly, or that deforms and moves: for each frame a pose, from mesh to world
/// coordinates. One pose: at rest.
struct AnimatedBody {
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
                                           // the mesh's coordinates; empty: rigid [m]
  /// A vertex in a frame with these `body_vertices`, in the mesh's coordinates.
  Vec3 vertex(std::size_t v, const std::vector<float>& body_vertices) const {
    if (body_vertices.empty()) return mesh.positions[v];
    return Eigen::Map<const Eigen::Vector3f>(&body_vertices[3 * v]).cast<double>();
  }

  std::optional<SolidShape> shape;  // exact shape of `mesh`, in its coordinates; empty: only the mesh
};

struct Animation {
  std::string title;
  double frames_per_second = 60;  // > 0
  std::vector<AnimatedCloth> cloths;
  std::vector<AnimatedBody> bodies;
  std::vector<std::array<std::string, 2>> passing = {};  // names of pairs that do not collide
};

/// One frame of an animation.
struct AnimationFrame {
  std::vector<std::vector<float>> cloths;         // (num_cloths) of (num_vertices x 3), world space [m]
  std::vector<AnimatedBody::Pose> poses;          // (num_bodies)
  std::vector<std::vector<float>> body_vertices;  // (num_bodies) as in AnimatedBody::frames; empty for a body
                                                  // that does not deform [m]
  std::vector<std::vector<float>> values =
      {};  // (num_cloths) of (num_vertices) shown by colours; empty: none
};

/// Frames in memory or in a file, read one by one.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual const Animation& meshes() const = 0;  // without frames
  virtual int num_frames() = 0;                 // >= 1; of an animation that is still written it grows
  virtual AnimationFrame read(int frame) = 0;   // in [0, num_frames())
};

/// The frames of an animation, which must outlive this.
class FramesInMemory final : public FrameSource {
 public:
  explicit FramesInMemory(const Animation& animation);
  const Animation& meshes() const override { return meshes_; }
  int num_frames() override;
  AnimationFrame read(int frame) override;

 private:
  const Animation& animation_;
  Animation meshes_;
};

/// All frames together.
Animation read_all(FrameSource& source);

/// A copy with meshes only.
Animation without_frames(const Animation& animation);

/// Number of frames, at least 1: the maximum over meshes.
std::size_t count_frames(const Animation& animation);

/// Frame `k` of the animation; a body with one pose has it in every frame.
AnimationFrame get_frame(const Animation& animation, std::size_t k);

/// Appends a frame. A body that is still at rest keeps one pose.
void append_frame(AnimationFrame frame, Animation& animation);

}  // namespace weft::engine
