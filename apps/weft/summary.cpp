#include "summary.h"

#include <fmt/core.h>

#include <algorithm>

namespace weft::engine::app {
namespace {

std::string format_depth(const RunReport& r) {
  return r.penetration_max ? fmt::format("{:.3g} mm", 1000 * *r.penetration_max) : "–";
}

std::string format_crossings(const RunReport& r) {
  return r.intersections ? fmt::format("{}", *r.intersections) : "–";
}

/// The frame with the largest excess of energy, if an energy audit found any.
std::string format_left_over(const std::vector<double>& left_over) {
  const auto most = std::max_element(left_over.begin(), left_over.end());
  if (*most <= 0) return "no unexplained energy in any frame";
  return fmt::format("at most {:.3g} J of unexplained energy, in frame {}", *most,
                     most - left_over.begin() + 1);
}

std::string first_passage_in_words(const RunReport& r) {
  return r.first_passage.empty() ? "" : ", first in " + r.first_passage;
}

double last(const std::vector<double>& values) { return values.empty() ? 0.0 : values.back(); }

}  // namespace

std::string summarise(const RunReport& r) {
  std::string text;
  text += fmt::format("{}: {} frames, {:.2f} s simulated with {}\n", r.scene, r.frames, r.seconds_simulated,
                      r.integrator);
  text += fmt::format("  cloth        {} particles, {} triangles, {} springs\n", r.particles, r.triangles,
                      r.springs);
  text += fmt::format("  time         {:.2f} ms per frame (95 %: {:.2f} ms), {:.2f} ms of CPU, {} thread{}\n",
                      r.ms_per_frame_median, r.ms_per_frame_p95, r.cpu_ms_per_frame, r.threads,
                      r.threads == 1 ? "" : "s");
  text += fmt::format("  strain       {:+.1f} % to {:+.1f} %, mean {:+.2f} %\n", 100 * r.min_strain,
                      100 * r.max_strain, 100 * r.mean_strain);
  text += fmt::format("  energy       {:.3g} J kinetic, {:.3g} J potential at the end\n",
                      last(r.kinetic_energy), last(r.potential_energy));
  if (!r.energy.left_over.empty())
    text += fmt::format("  audit        {}\n", format_left_over(r.energy.left_over));
  text += fmt::format("  lowest point {:.3f} m at the end\n", last(r.lowest_y));
  if (r.torn > 0) text += fmt::format("  tears        {} cuts\n", r.torn);
  if (r.intersections) text += fmt::format("  crossings    {} in the worst frame\n", *r.intersections);
  if (r.passages) text += fmt::format("  passages     {}{}\n", *r.passages, first_passage_in_words(r));
  if (r.penetration_max) text += fmt::format("  penetration  at most {}\n", format_depth(r));
  text += fmt::format("  state hash   {}\n", r.state_hash);
  for (const std::string& note : r.notes) text += "  note: " + note + "\n";
  for (const std::string& warning : r.warnings) text += "  warning: " + warning + "\n";
  if (!r.failure.empty()) text += "  failed at " + r.failure + "\n";
  return text;
}

std::string describe_problems(const RunReport& r) {
  std::string text;
  for (const RunProblem& p : r.problems) {
    text += fmt::format("  problem: {} ({}{})\n", p.message, to_string(p.code),
                        p.frames > 1 ? fmt::format(", {} times", p.frames) : "");
  }
  return text;
}

std::string table_head() {
  return fmt::format("{:<26} {:>9} {:>7} {:>9} {:>16} {:>10} {:>9} {:>12}\n", "scene", "particles", "frames",
                     "ms/frame", "strain", "lowest", "crossings", "penetration");
}

std::string table_line(const RunReport& r) {
  const std::string strain = fmt::format("{:+.1f} … {:+.1f} %", 100 * r.min_strain, 100 * r.max_strain);
  // fmt counts each dot as one column, as a terminal does.
  return fmt::format("{:<26} {:>9} {:>7} {:>9.2f} {:>16} {:>8.3f} m {:>9} {:>12}\n", r.scene, r.particles,
                     r.frames, r.ms_per_frame_median, strain, last(r.lowest_y), format_crossings(r),
                     format_depth(r));
}

}  // namespace weft::engine::app
