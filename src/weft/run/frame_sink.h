#pragma once
/// Receivers of a run's frames.

#include "weft/core/archive.h"
#include "weft/report.h"
#include "weft/run/report.h"

namespace weft::engine {

class SceneRun;

/// A sink receives every frame once. The memory of a run grows with its frames only if a sink keeps them. A
/// sink may add its results to the run's report.
class FrameSink {
 public:
  virtual ~FrameSink() = default;

  /// Frame 0, the start, before the first step. May throw InputError to refuse it.
  virtual void begin(SceneRun& run, RunReport& report) = 0;

  /// Before and after every step of a frame.
  virtual void begin_step(const SceneRun&) {}
  virtual void end_step(const SceneRun&, const StepReport&, RunReport&) {}

  /// A frame is done; run.frame() is its number.
  virtual void add_frame(const SceneRun& run, RunReport& report) = 0;

  /// End of the run, complete or not.
  virtual void finish(const SceneRun&, RunReport&) {}

  /// Passes what it has received to the disk, for SceneRun::save().
  virtual void sync() {}

  /// Appends its state after a frame.
  virtual void save(Writer&) {}

  /// Instead of begin(): continues from the state that another sink of its kind has saved. Throws InputError if
  /// it cannot; by default always.
  virtual void resume(SceneRun& run, RunReport& report, Reader& saved);
};

inline void FrameSink::resume(SceneRun&, RunReport&, Reader&) {
  throw InputError("a receiver of this run's frames cannot continue it");
}

}  // namespace weft::engine
