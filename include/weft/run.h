#pragma once
/// Runs: a scene simulated to its end, checked and reported, as `weft run` does. Link weft::scene.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "weft/export.h"
#include "weft/scene.h"

namespace weft {

enum class RunOutcome {
  done,
  interrupted,  // ended by the caller; the finished frames are kept
  failed,       // a step failed; the frames before it are kept
};

/// What to do about an unfinished run in the folder: one that was killed, or whose files could not be written.
enum class Unfinished {
  refuse,   // InputError
  resume,   // continue it from its last checkpoint; without an unfinished run, begin
  discard,  // begin again
};

struct RunOptions {
  std::optional<int> frames = {};  // >= 1; instead of the scene's duration times frames per second [1]
  int threads = 1;                 // >= 1; the result does not depend on it
  bool audit = false;              // also the energy balance of every step; slower
  bool check_passages = true;      // also the check for tunnelling within steps
  std::string folder = {};         // of the results, created if necessary; empty: no files
  bool pc2 = true;   // CLOTH.pc2: a point cache per cloth, the vertices of its mesh in their order; and
                     // CLOTH.mesh.obj, that mesh at the start
  bool glb = true;   // animation.glb: cloths and colliders
  bool obj = false;  // obj/CLOTH_0000.obj: a file per cloth and frame, 0 being the start
  /// DIR@FRAME, DIR@last or DIR: a frame of an earlier run, the last one without a number. Cloths of the same
  /// name begin with its positions. Their velocities are differences of its frames: an approximation, while a
  /// resumed run continues exactly. Empty: all cloths begin as the scene says.
  std::string start_from = {};
  Unfinished unfinished = Unfinished::refuse;
  double checkpoint_seconds = 30;  // of simulation and output, between checkpoints in the folder; >= 0 [s]
  std::optional<int> checkpoint_every = {};  // instead: frames between them, >= 1 [1]
  /// Called while the scene is prepared, at most every tenth of a second: "repairing the start, round 7".
  std::function<void(const std::string& what)> on_preparation = {};
  /// Asked between the steps of a frame; false interrupts the run without the unfinished frame.
  std::function<bool()> keep_going = {};
};

/// Progress of a run.
struct Progress {
  int frame = 0;             // done
  int num_frames = 0;        // of
  double seconds_spent = 0;  // on simulation so far, wall time [s]
  double seconds_left = 0;   // at the present pace [s]
};

/// Called after every frame; false interrupts the run.
using OnFrame = std::function<bool(const Progress&)>;

struct RunResult {
  RunOutcome outcome = RunOutcome::done;
  std::string failure = {};                // the reason, if failed
  std::string report = {};                 // JSON, as in report.json
  std::string state_hash = {};             // of the last step's state; sixteen hexadecimal digits
  std::vector<std::string> problems = {};  // reasons not to trust the result, as sentences; empty: none found
  std::vector<std::string> files = {};     // written ones, run.json last
};

/// Simulates a scene and checks every frame. With a folder, its files are replaced when the new ones are
/// complete; run.json lists them. Until then the new ones are in FOLDER/unfinished, with a checkpoint: a run
/// that was killed can be continued, and ends with the same files as an unbroken one, times in the report
/// aside. Throws InputError for bad input and for files that cannot be written; results of an earlier run then
/// stay. The callbacks are called on the calling thread; their exceptions pass through, with the same effect.
WEFT_API RunResult run(const Scene& scene, const RunOptions& options = {}, const OnFrame& on_frame = {});

}  // namespace weft
