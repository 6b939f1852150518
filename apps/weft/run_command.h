#pragma once
/// One scene from file to result files; `weft demo` uses it eight times.

#include <filesystem>
#include <string>
#include <vector>

#include "weft/run/run_folder.h"
#include "weft/scene/scene_reader.h"

namespace weft::engine::app {

struct RunRequest {
  std::string scene;  // a file, or the name of a shipped scene; empty: that of the unfinished run in `folder`
  Overrides overrides;
  RunOptions options{.threads = 0};  // no folder: out/ and the scene's name; 0 threads: all processors
  std::filesystem::path report;      // a second copy of the report; empty: none
  bool strict = false;               // problems are an error
  std::string resume;                // folder of an unfinished run to continue; empty: none
  bool fresh = false;                // discards an unfinished run
};

/// Reads the scene, and runs it to its folder with a progress bar; a signal interrupts it. Throws InputError as
/// run_to_folder() does, and for a report that cannot be written.
FinishedRun run_to_files(RunRequest request, const std::vector<FrameSink*>& sinks = {});

/// Exit code of an outcome.
int exit_code_of(RunOutcome outcome);

}  // namespace weft::engine::app
