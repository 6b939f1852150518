#pragma once
/// Reference motions: by `explicit` with steps far below its stability limit, cached on disk.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lab/accuracy/hung_cloth.h"

namespace weft::engine::lab {

inline constexpr double kReferenceFrame = 1.0 / 60;  // [s]

struct Reference {
  std::vector<std::vector<float>> frames;  // (frames x 3 num_particles) xyz interleaved, from the origin [m]
  double error = 0;                        // mean distance of the motion with half as many substeps [m]
  double strain = 0;                       // maximum over all frames [1]
};

/// From the cache in `folder`, else computed and stored there. Calls `say` before a computation, which takes
/// minutes for large cloth. The file name is a hash of all inputs: cloth, number of frames, method and its
/// version. Throws InputError if the folder cannot be written.
Reference find_reference(const HungCloth& cloth, int num_frames, const std::filesystem::path& folder,
                         const std::function<void(const std::string&)>& say = {});

/// Offsets from the cloth's origin, in the layout of a reference (3 num_particles) [m].
std::vector<float> frame_of(const ClothState& state);

/// Root mean square distance of a cloth from a frame of its reference [m].
double distance_from(const std::vector<float>& frame, const ClothState& state);

/// $XDG_CACHE_HOME/weft, or ~/.cache/weft, or a folder for temporary files.
std::filesystem::path default_cache_folder();

}  // namespace weft::engine::lab
