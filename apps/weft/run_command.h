#pragma once
/// One scene from file to files; also used by `weft demo`, eight times.

#include <filesystem>
#include <optional>
#include <string>

#include "weft/run/runner.h"
#include "weft/scene/scene_reader.h"

namespace weft::engine::app {

struct RunRequest {
  std::string scene;             // a file, or the name of a shipped scene
  std::filesystem::path out;     // folder for animation.glb and report.json; empty: out/ and the scene's name
  std::filesystem::path report;  // a second copy of the report; empty: none
  std::optional<int> frames;
  int threads = 0;             // 0: all processors
  bool audit = false;          // energy audit in the report
  bool strict = false;         // problems are an error
  bool check_passages = true;  // within steps
  Overrides overrides;
};

struct FinishedRun {
  RunReport report;
  Animation animation;
  std::filesystem::path animation_file, report_file;
};

/// Reads and simulates with a progress bar, then replaces the results of an earlier run. Throws InputError
/// for bad input and unwritable paths, before simulating where possible; then the earlier results stay.
FinishedRun run_to_files(const RunRequest& request);

/// Exit code of an outcome.
int exit_code_of(RunOutcome outcome);

}  // namespace weft::engine::app
