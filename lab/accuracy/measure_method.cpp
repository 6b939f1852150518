#include "lab/accuracy/measure_method.h"

#include <algorithm>
#include <cmath>

#include "weft/run/stopwatch.h"
#include "weft/world/measures.h"

namespace weft::engine::lab {
namespace {

constexpr int kMaxRuns = 3;    // the fastest counts, because of other processes
constexpr double kEnough = 3;  // no further run after this time [s]

/// One run of all frames.
MethodResult run_once(const MakeMethod& make, const MethodSettings& entry, const HungCloth& cloth,
                      const Reference& reference) {
  const auto method = make();
  const auto num_frames = static_cast<double>(reference.frames.size());
  MethodResult result{.method = entry.method, .setting = entry.setting};
  Stopwatch watch;
  for (const auto& frame : reference.frames) {
    watch.start();
    method->advance_frame();
    watch.stop();
    const ClothState& state = method->state();
    const double distance = distance_from(frame, state);
    result.ok = distance < kLargeError;
    if (!result.ok) return result;
    result.error += distance / num_frames;
    result.strain = std::max(result.strain, compute_strain(*cloth.model, state).max);
  }
  result.cpu_ms = 1000 * watch.cpu_total() / num_frames;
  return result;
}

/// Pareto frontier of a method, by ascending time: results better than all cheaper ones.
std::vector<MethodResult> frontier_of(const std::string& method, std::vector<MethodResult> results,
                                      const Objective& objective) {
  std::erase_if(results, [&](const MethodResult& r) { return r.method != method || !r.ok; });
  std::sort(results.begin(), results.end(),
            [](const MethodResult& a, const MethodResult& b) { return a.cpu_ms < b.cpu_ms; });
  std::vector<MethodResult> front;
  for (const MethodResult& r : results) {
    if (front.empty() || objective(r) < objective(front.back())) front.push_back(r);
  }
  return front;
}

}  // namespace

MethodResult measure_method(const MakeMethod& make, const MethodSettings& entry, const HungCloth& cloth,
                            const Reference& reference) {
  MethodResult best = run_once(make, entry, cloth, reference);
  const double seconds = best.cpu_ms / 1000 * static_cast<double>(reference.frames.size());
  for (int r = 1; r < kMaxRuns && r * seconds < kEnough && best.ok; ++r) {
    best.cpu_ms = std::min(best.cpu_ms, run_once(make, entry, cloth, reference).cpu_ms);
  }
  return best;
}

std::optional<double> find_time(const std::string& method, const std::vector<MethodResult>& results,
                                const Objective& objective) {
  const std::vector<MethodResult> front = frontier_of(method, results, objective);
  for (std::size_t i = 0; i < front.size(); ++i) {
    const double now = objective(front[i]);
    if (now > 1) continue;
    if (i == 0) return front[0].cpu_ms;
    const double before = objective(front[i - 1]), share = std::log(before) / std::log(before / now);
    return front[i - 1].cpu_ms * std::pow(front[i].cpu_ms / front[i - 1].cpu_ms, share);
  }
  return std::nullopt;
}

PlotPanel make_panel(const std::string& title, const std::vector<MethodResult>& results) {
  PlotPanel panel{title, {}};
  for (const MethodResult& r : results) {
    if (!r.ok) continue;
    if (panel.series.empty() || panel.series.back().name != r.method) panel.series.push_back({r.method, {}});
    panel.series.back().points.push_back({r.cpu_ms, r.error, r.method + ", " + r.setting});
  }
  for (PlotSeries& series : panel.series) {
    std::sort(series.points.begin(), series.points.end(),
              [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
  }
  return panel;
}

}  // namespace weft::engine::lab
