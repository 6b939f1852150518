#pragma once
/// Writer for animations: binary glTF 2.0 (.glb), for browsers, Blender and most viewers.
///
/// The first frame is the mesh in the file. Every further frame is a morph target (positions and normals).
/// One animation blends linearly from frame to frame. The same for bodies that deform.

#include <cstddef>
#include <filesystem>
#include <memory>

#include "weft/core/staged_file.h"
#include "weft/io/animation.h"

namespace weft::engine {

/// Writes an animation frame by frame. Frames are spooled to disk, beside the file: memory grows by some
/// kilobytes per frame and mesh, independent of the number of vertices.
///
/// Materials are double-sided. A cloth has the texture coordinates of its file, and behind them the fabric
/// coordinates in metres. The attribute `_PARTICLE` of a cloth with ShownVertices is the particle of each
/// vertex.
///
/// Data without a glTF equivalent is in the nodes' extras. Of cloth that is `"weft": {"role": "cloth", "fabric":
/// "TEXCOORD_1", "fabric_name": "denim"}`, with the attribute of its fabric coordinates and the fabric's name. Of
/// bodies it is `{"role": "collider", "shape": "sphere", "center": [0, 0, 0], "radius": 0.3}`. Other shapes are
/// `plane` (point, normal), `capsule` (a, b, radius), `box` (center, half_size, rotation: nine numbers row by row)
/// and `mesh`. The asset's extras hold
/// `title` and `passing`.
///
/// The lengths in a .glb have 32 bits, so that it holds less than 4 GiB: see max_frames(). All functions throw
/// InputError if the file cannot be written, with the system's reason, or is full. They also throw it for a
/// frame that viewers cannot show: other meshes than before, or coordinates that are not finite.
class GlbWriter {
 public:
  /// Requires at least one mesh. Frames in `meshes` are not written.
  GlbWriter(StagedFile& file, const Animation& meshes);
  ~GlbWriter();

  void add_frame(const AnimationFrame& frame);

  /// Number of frames that the file has room for; known after the first frame.
  std::size_t max_frames() const;

  /// Writes the file up to StagedFile::finish(), after at least one frame; the caller calls replace().
  void finish();

 private:
  class Builder;
  std::unique_ptr<Builder> builder_;
};

/// Writes a whole animation, whose meshes all have the same number of frames (>= 1). An earlier file is
/// replaced completely or not at all.
void write_glb(const std::filesystem::path& file, const Animation& animation);

}  // namespace weft::engine
