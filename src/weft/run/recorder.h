#pragma once
/// A run's energies, strains and problems.

#include <optional>

#include "weft/run/frame_sink.h"
#include "weft/run/problems.h"
#include "weft/world/energy_audit.h"

namespace weft::engine {

/// Adds them to the run's report.
class Recorder : public FrameSink {
 public:
  /// `audit`: also the energy balance of every step (world/energy_audit.h). The motion stays the same; a
  /// step's time then includes the tracking of contacts, not the audit.
  explicit Recorder(bool audit = false) : has_audit_(audit) {}

  void begin(SceneRun& run, RunReport& report) override;
  void begin_step(const SceneRun& run) override;
  void end_step(const SceneRun& run, const StepReport& step, RunReport& report) override;
  void add_frame(const SceneRun& run, RunReport& report) override;
  void finish(const SceneRun& run, RunReport& report) override;
  void save(Writer& out) override;
  void resume(SceneRun& run, RunReport& report, Reader& saved) override;

 private:
  bool has_audit_;
  std::optional<ProblemFinder> problems_;
  std::optional<AuditStart> step_;
  EnergyAudit frame_;
};

}  // namespace weft::engine
