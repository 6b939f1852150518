#include "weft/run/frame_checker.h"

#include <algorithm>

#include "weft/error.h"
#include "weft/run/run_archive.h"
#include "weft/run/scene_run.h"
#include "weft/run/start_check.h"

namespace weft::engine {
namespace {

void check_start(const SceneDesc& scene, const World& world, RunReport& report) {
  const std::vector<std::string> found = check_start(world);
  report.warnings.insert(report.warnings.end(), found.begin(), found.end());
  if (const std::optional<std::string> refusal = refuse_start(scene, found)) throw InputError(*refusal);
}

}  // namespace

void FrameChecker::begin(SceneRun& run, RunReport& report) {
  check_start(run.scene(), run.world(), report);
  if (has_passages_) report.passages = 0;
  watch(run, report);
}

void FrameChecker::watch(SceneRun& run, RunReport& report) {
  frames_.emplace(run.world());
  if (!has_passages_) return;
  watch_.emplace(frames_->now().frame);
  run.observe([this, &report, frame = &run](double time) {
    const FrameToCheck moment = frames_->at(time);
    const std::vector<verify::FeaturePair> passages = watch_->advance(moment.frame);
    if (passages.empty()) return;
    if (report.passages == 0)
      report.first_passage =
          "frame " + std::to_string(frame->frame() + 1) + ": " + verify::describe(moment.frame, passages[0]);
    *report.passages += static_cast<int>(passages.size());
  });
}

void FrameChecker::add_frame(const SceneRun&, RunReport& report) {
  const FrameToCheck now = frames_->now();
  const verify::FrameCheck check = verify::check_frame(now.frame, 0);
  report.crossings_at_end = check.intersections;
  report.intersections = std::max(report.intersections.value_or(0), check.intersections);
  report.inside_at_end = find_inside(now.frame, check.deepest);
  if (!check.deepest) return;
  report.penetration_max = std::max(report.penetration_max.value_or(0), check.penetration());
}

void FrameChecker::save(Writer& out) {
  if (!watch_) return;
  verify::PassageWatch::Pending pending = watch_->pending();
  describe(out, pending);
}

void FrameChecker::resume(SceneRun& run, RunReport& report, Reader& saved) {
  watch(run, report);
  if (!watch_) return;
  verify::PassageWatch::Pending pending;
  describe(saved, pending);
  watch_->set_pending(std::move(pending));
}

void FrameChecker::finish(const SceneRun&, RunReport& report) {
  if (!watch_ || watch_->num_left_out() == 0) return;
  report.warnings.push_back("passages are not counted in " + std::to_string(watch_->num_left_out()) +
                            " substeps in which cloth moved by more than its own size");
}

}  // namespace weft::engine
