#pragma once
/// The independent checker (verify/checker.h) on every frame and step of a run.

#include <memory>
#include <optional>

#include "weft/run/frame_checks.h"
#include "weft/run/frame_sink.h"
#include "weft/verify/passages.h"

namespace weft::engine {

/// Adds intersections, depth inside colliders, and passages within steps to the run's report. Throws
/// InputError for initial intersections, unless the scene allows them. The checks do not count as simulation
/// time.
class FrameChecker : public FrameSink {
 public:
  explicit FrameChecker(bool check_passages = true) : has_passages_(check_passages) {}

  void begin(SceneRun& run, RunReport& report) override;
  void add_frame(const SceneRun& run, RunReport& report) override;
  void finish(const SceneRun& run, RunReport& report) override;
  void save(Writer& out) override;
  void resume(SceneRun& run, RunReport& report, Reader& saved) override;

 private:
  void watch(SceneRun& run, RunReport& report);

  bool has_passages_;
  std::optional<WorldFrames> frames_;
  std::optional<verify::PassageWatch> watch_;
};

}  // namespace weft::engine
