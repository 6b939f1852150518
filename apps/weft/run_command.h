#pragma once
/// One scene from file to result files; `weft demo` uses it eight times.

#include <filesystem>
#include <optional>
#include <string>

#include "weft/run/scene_run.h"
#include "weft/scene/scene_reader.h"

namespace weft::engine::app {

struct RunRequest {
  std::string scene;             // a file, or the name of a shipped scene
  std::filesystem::path out;     // folder of the results; empty: out/ and the scene's name
  std::filesystem::path report;  // a second copy of the report; empty: none
  std::optional<int> frames;
  int threads = 0;               // 0: all processors
  bool audit = false;            // energy audit in the report
  bool strict = false;           // problems are an error
  bool check_passages = true;    // within steps
  bool glb = true, obj = false;  // animation.glb; the folder obj, a file per cloth and frame
  Overrides overrides;
};

struct FinishedRun {
  RunReport report;
  std::vector<std::filesystem::path> files;  // written ones, the report last
};

/// Reads, simulates with a progress bar, and replaces the results of an earlier run. `sinks` receive the
/// frames too. Throws InputError for bad input and unwritable folders, if possible before the simulation; the
/// earlier results then stay.
FinishedRun run_to_files(const RunRequest& request, const std::vector<FrameSink*>& sinks = {});

/// Exit code of an outcome.
int exit_code_of(RunOutcome outcome);

}  // namespace weft::engine::app
