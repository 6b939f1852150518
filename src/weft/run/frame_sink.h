#pragma once
/// Receivers of a run's frames, as they are made.

#include "weft/run/report.h"
#include "weft/report.h"

namespace weft::engine {

class SceneRun;

/// A sink gets every frame once and keeps what it needs: a run's memory does not grow with its frames unless
/// a sink keeps them. A sink may add its results to the run's report.
class FrameSink {
 public:
  virtual ~FrameSink() = default;

  /// The start, before the first step: frame 0. May throw InputError to refuse it.
  virtual void begin(SceneRun& run, RunReport& report) = 0;

  /// Before and after every step of a frame.
  virtual void begin_step(const SceneRun&) {}
  virtual void end_step(const SceneRun&, const StepReport&, RunReport&) {}

  /// A frame is done; run.frame() is its number.
  virtual void add_frame(const SceneRun& run, RunReport& report) = 0;

  /// The run has ended, complete or not.
  virtual void finish(const SceneRun&, RunReport&) {}
};

}  // namespace weft::engine
