#pragma once
/// Checkpoints: what an unfinished run needs to be continued.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "weft/run.h"
#include "weft/scene/scene_desc.h"

namespace weft::engine {

/// What two runs must share for one to continue the other: lines `key = value`, with sections as in scene
/// files. The contents of mesh files are in it as hashes.
std::string describe_run(const SceneDesc& scene, int num_frames, const RunOptions& options);

/// RunOptions::start_from with an absolute folder; empty: none.
std::string full_start_from(const RunOptions& options);

/// The first difference, as `[solver] integrator = "newton" there, integrator = "xpbd" here`; empty: none.
std::string find_difference(const std::string& there, const std::string& here);

struct Checkpoint {
  std::string scene_name;
  std::string description;  // describe_run()
  int frame = 0, num_frames = 0;
  bool check_passages = true, audit = false, pc2 = true, glb = true, obj = false;  // as in RunOptions
  std::string start_from;                                                          // full_start_from()
  std::uint64_t start = 0;     // hash of what it had there
  std::vector<std::byte> run;  // SceneRun::save()
};

/// Replaces the file: written aside, flushed to disk, renamed. Throws InputError, and leaves the earlier file
/// as it was, if it cannot be written.
void write_checkpoint(const std::filesystem::path& file, Checkpoint checkpoint);

/// Throws InputError for a file that cannot be read, is damaged or of another version.
Checkpoint read_checkpoint(const std::filesystem::path& file);

}  // namespace weft::engine
