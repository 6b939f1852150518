#include "weft/lab/contest.h"

#include <algorithm>
#include <cmath>

#include "weft/run/stopwatch.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

constexpr int kMostRuns = 3;   // of which the fastest counts: others may be using the machine …
constexpr double kEnough = 3;  // … but none after so much time [s]

/// One run of all frames.
ContestResult run_once(const MakeContestant& make, const ContestantSettings& entry, const HungCloth& cloth,
                       const Reference& reference) {
  const auto contestant = make();
  const auto num_frames = static_cast<double>(reference.frames.size());
  ContestResult result{.method = entry.method, .setting = entry.setting};
  Stopwatch watch;
  for (const auto& frame : reference.frames) {
    watch.start();
    contestant->advance_frame();
    watch.stop();
    const ClothState& state = contestant->state();
    const double distance = distance_from(frame, state);
    result.ok = distance < kLargeError;
    if (!result.ok) return result;
    result.error += distance / num_frames;
    result.strain = std::max(result.strain, compute_strain(*cloth.model, state).max);
  }
  result.cpu_ms = 1000 * watch.cpu_total() / num_frames;
  return result;
}

/// The results of a method that no cheaper one of it beats, by ascending time.
std::vector<ContestResult> frontier_of(const std::string& method, std::vector<ContestResult> results,
                                       const Misfit& misfit) {
  std::erase_if(results, [&](const ContestResult& r) { return r.method != method || !r.ok; });
  std::sort(results.begin(), results.end(),
            [](const ContestResult& a, const ContestResult& b) { return a.cpu_ms < b.cpu_ms; });
  std::vector<ContestResult> front;
  for (const ContestResult& r : results) {
    if (front.empty() || misfit(r) < misfit(front.back())) front.push_back(r);
  }
  return front;
}

}  // namespace

ContestResult measure_contestant(const MakeContestant& make, const ContestantSettings& entry,
                                 const HungCloth& cloth, const Reference& reference) {
  ContestResult best = run_once(make, entry, cloth, reference);
  const double seconds = best.cpu_ms / 1000 * static_cast<double>(reference.frames.size());
  for (int r = 1; r < kMostRuns && r * seconds < kEnough && best.ok; ++r) {
    best.cpu_ms = std::min(best.cpu_ms, run_once(make, entry, cloth, reference).cpu_ms);
  }
  return best;
}

std::optional<double> find_time(const std::string& method, const std::vector<ContestResult>& results,
                                const Misfit& misfit) {
  const std::vector<ContestResult> front = frontier_of(method, results, misfit);
  for (std::size_t i = 0; i < front.size(); ++i) {
    const double now = misfit(front[i]);
    if (now > 1) continue;
    if (i == 0) return front[0].cpu_ms;
    const double before = misfit(front[i - 1]), share = std::log(before) / std::log(before / now);
    return front[i - 1].cpu_ms * std::pow(front[i].cpu_ms / front[i - 1].cpu_ms, share);
  }
  return std::nullopt;
}

PlotPanel make_panel(const std::string& title, const std::vector<ContestResult>& results) {
  PlotPanel panel{title, {}};
  for (const ContestResult& r : results) {
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

}  // namespace weft::engine
