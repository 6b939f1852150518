#include "lab/benchmarks/random_contact.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>

#include "lab/benchmarks/random_contact_scene.h"
#include "weft/core/make_folder.h"
#include "weft/error.h"
#include "weft/run/scene_run.h"
#include "weft/run/warnings.h"
#include "weft/scene/scene_reader.h"

namespace weft::engine::lab {
namespace {

constexpr double kDeep = 1e-6;  // in a body: more is a penetration [m]

/// Counts of scenes.
struct Summary {
  int refused = 0, wrong = 0, infeasible = 0, with_problems = 0;
  double cpu_seconds = 0;
};

void add_scene(std::uint64_t seed, const std::filesystem::path& folder, const RandomContactOptions& options,
               Summary& summary) {
  RunReport report;
  try {
    report = run_scene(read_scene(write_random_contact_scene(folder, seed)),
                       {.frames = options.frames, .threads = options.threads});
  } catch (const InputError& error) {
    ++summary.refused;
    fmt::print("seed {}: refused: {}\n", seed, error.what());
    return;
  }
  const int crossings = report.intersections.value_or(0), passages = report.passages.value_or(0);
  const double depth = report.penetration_max.value_or(0);
  const bool is_infeasible = report.infeasible && !report.infeasible->empty();
  const bool is_wrong = report.outcome != RunOutcome::done || crossings > 0 || passages > 0 || depth > kDeep;
  summary.wrong += is_wrong && !is_infeasible;
  summary.infeasible += is_infeasible;
  summary.with_problems += !report.problems.empty();
  summary.cpu_seconds += report.cpu_ms_per_frame * report.frames / 1000;
  if (!is_wrong && report.problems.empty()) return;
  fmt::print(
      "seed {}: {}{} intersections, {} passages, {:.3g} mm deep, {} infeasible; {} parts, {:.0f} ms a frame",
      seed, report.outcome == RunOutcome::done ? "" : "failed, ", crossings, passages, 1000 * depth,
      report.infeasible ? report.infeasible->size() : 0,
      report.divisions.empty() ? 1 : *std::max_element(report.divisions.begin(), report.divisions.end()),
      report.cpu_ms_per_frame);
  for (const RunProblem& problem : report.problems)
    fmt::print("; {} {:.3g}", to_string(problem.code), problem.value);
  fmt::print("\n");
  std::fflush(stdout);
}

}  // namespace

bool bench_random_contact(const RandomContactOptions& options) {
  const std::filesystem::path folder =
      options.out.empty() ? std::filesystem::temp_directory_path() / "weft_random" : options.out;
  make_folder(folder);
  Summary summary;
  for (int s = 0; s < options.scenes; ++s)
    add_scene(static_cast<std::uint64_t>(options.first_seed + s), folder, options, summary);
  fmt::print(
      "\n{} scenes of {} frames, {:.0f} s of CPU time: {} refused; {} with intersections, passages or "
      "penetrations and without infeasible pairs; {} with infeasible pairs; {} with problems reported. "
      "Scenes in {}\n",
      options.scenes, options.frames, summary.cpu_seconds, summary.refused, summary.wrong, summary.infeasible,
      summary.with_problems, folder.string());
  return summary.refused == 0 && summary.wrong == 0;
}

}  // namespace weft::engine::lab
