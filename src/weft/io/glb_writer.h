#pragma once
/// Animations out: binary glTF 2.0 (.glb), which browsers, Blender and most viewers open.
///
/// In the file the first frame is the mesh, every further frame a morph target (positions and normals), and
/// one animation blends linearly from frame to frame. Bodies that deform likewise.

#include <cstddef>
#include <filesystem>
#include <memory>

#include "weft/core/staged_file.h"
#include "weft/io/animation.h"

namespace weft::engine {

/// Writes an animation frame by frame. Frames wait on disk, beside the file: memory grows by some kilobytes
/// per frame and mesh, whatever the number of vertices.
///
/// Materials are double-sided, fabric coordinates become texture coordinates in metres. Data that glTF has no
/// words for goes to the nodes' extras, as `"weft": {"role": "cloth"}` or `{"role": "collider", "shape":
/// "sphere", "center": [0, 0, 0], "radius": 0.3}`; other shapes are `plane` (point, normal), `capsule` (a, b,
/// radius), `box` (center, half_size, rotation: nine numbers row by row) and `mesh`. The asset's extras hold
/// `title` and `passing`.
///
/// The lengths in a .glb have 32 bits, so that it holds less than 4 GiB: see glb_size(). All functions throw
/// InputError: if the file cannot be written, with the system's reason, if it is full, and for a frame that
/// no viewer could show (other meshes than before, or coordinates that are not finite).
class GlbWriter {
 public:
  /// At least one mesh; frames that `meshes` has are not written.
  GlbWriter(StagedFile& file, const Animation& meshes);
  ~GlbWriter();

  void add_frame(const AnimationFrame& frame);

  /// Writes the file up to StagedFile::finish(), after at least one frame; replace() is left to the caller.
  void finish();

 private:
  class Builder;
  std::unique_ptr<Builder> builder_;
};

/// Size of the file, without its JSON text [bytes].
std::size_t glb_size(const Animation& meshes, std::size_t num_vertices, std::size_t num_frames);

/// What a .glb can hold at most [bytes].
std::size_t max_glb_size();

/// Writes a whole animation: all its meshes have the same number of frames (>= 1). An earlier file is
/// replaced whole or not at all.
void write_glb(const std::filesystem::path& file, const Animation& animation);

}  // namespace weft::engine
