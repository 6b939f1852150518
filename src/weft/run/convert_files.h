#pragma once
/// Conversion of files: meshes, point caches, and the point caches of a run.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace weft::engine {

struct ConvertOptions {
  std::optional<double> fps = {};  // of point caches without one, > 0; default 60 [1/s]
  bool up_is_z = false;            // of the input: rotated, so that its z axis becomes the output's y axis
  double scale = 1;                // length of the input's unit, > 0 [m]
  int first_frame = 0;             // of a point cache, >= 0
  std::optional<int> last_frame = {};
  std::filesystem::path mesh = {};  // of a point cache's points, to write meshes: OBJ, PLY or STL
};

struct Converted {
  std::vector<std::filesystem::path> files;  // written
  std::vector<std::string> notes;  // what a format could not say or hold, and absurd sizes, as sentences
};

/// `in` is a mesh (OBJ, PLY, STL), a point cache (PC2, MDD), or the folder of a run; `out` a file of the same
/// kind (OBJ, PLY; PC2, MDD), by its ending. Of a run with several cloths each has its own file: `walk.mdd`
/// becomes `walk_skirt.mdd`. Point caches also become a sequence of meshes, `walk_0000.obj` being frame 0. A
/// run has their mesh, another cache needs `mesh`. Frames are read and written one by one. Throws InputError
/// for files that cannot be read, written or converted; an earlier file of that name then stays as it was.
Converted convert_files(const std::filesystem::path& in, const std::filesystem::path& out,
                        const ConvertOptions& options);

}  // namespace weft::engine
