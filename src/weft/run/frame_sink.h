#pragma once
/// Receivers of a run's frames.

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
};

}  // namespace weft::engine
