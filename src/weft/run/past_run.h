#pragma once
/// The results of a run in its folder, finished or not.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "weft/io/point_cache_reader.h"
#include "weft/scene/scene_desc.h"

namespace weft::engine {

struct PastCloth {
  std::string name;
  std::filesystem::path cache;  // its point cache; empty: none
  std::filesystem::path mesh;   // of the cache's points; empty: none
};

struct PastRun {
  std::filesystem::path folder;
  std::string name;                 // of the scene
  double fps = 60;                  // frames per second, > 0
  std::vector<PastCloth> cloths;    // at least one
  std::filesystem::path animation;  // empty: none
  std::filesystem::path frames;     // of an unfinished run's animation, in a log (frame_log.h); empty: none
  std::filesystem::path scene;      // with all changes; empty: none
  std::string scene_hash;           // hash_of_scene() at the run; in use for a finished one
  std::filesystem::path report;     // empty: none
};

/// The results that the folder's run.json lists; without that file, those of its unfinished run so far. Throws
/// InputError if there are none.
PastRun read_past_run(const std::filesystem::path& folder);

/// Counts of a run at its frames after the start (num_frames), from its report; each may be empty.
struct PastCounts {
  std::vector<int> divisions, newton_steps, cg_iterations;
};
PastCounts read_counts(const PastRun& run);

/// Hash of a scene and of its meshes' contents, as sixteen hexadecimal digits. Throws InputError for a mesh that
/// cannot be read.
std::string hash_of_scene(const SceneDesc& scene);

/// Throws InputError for a cloth without a point cache, and for a damaged one.
std::unique_ptr<PointCacheReader> open_cache(const PastRun& run, const PastCloth& cloth);

}  // namespace weft::engine
