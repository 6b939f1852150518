#pragma once
/// Scene in, frames out: what the program, and later Python and the page, call.

#include <functional>
#include <optional>

#include "weft/io/glb_writer.h"
#include "weft/run/report.h"
#include "weft/scene/scene_desc.h"
#include "weft/world/world.h"

namespace weft::engine {

struct RunOptions {
  std::optional<int> frames;     // instead of the scene's duration · fps [1]
  int threads = 1;               // >= 1; the result does not depend on it
  bool record_animation = true;  // keep every frame for a .glb
  /// Audit the energy of every step (world/energy_audit.h). The motion stays the same; a step's time includes
  /// the tracking of contacts, not the audit.
  bool audit = false;
  bool check_passages = true;  // what goes through what within steps; no part of the time that is measured
};

/// Where a run is.
struct Progress {
  int frame = 0;             // done
  int num_frames = 0;        // of
  double seconds_spent = 0;  // on simulation so far, wall time [s]
  double seconds_left = 0;   // at the present pace [s]
};

struct RunResult {
  RunReport report;
  Animation animation;  // the start and every frame that was done; empty if not recorded
};

/// Called after every frame; false ends the run there, keeping what was done.
using OnFrame = std::function<bool(const Progress&)>;

/// Simulates a scene. Throws InputError for bad input; a simulation that fails ends the run and is told by
/// report.outcome and report.failure.
RunResult run_scene(const SceneDesc& scene, const RunOptions& options, const OnFrame& on_frame = {});

/// The paper's Eq. 16 slows gravity the more, the stiffer the cloth is for its step: adds a sentence for each
/// cloth that is too stiff for it.
void warn_about_paper(const SceneDesc& scene, const World& world, std::vector<std::string>& warnings);

}  // namespace weft::engine
