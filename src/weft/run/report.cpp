#include "weft/run/report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "weft/core/staged_file.h"

namespace weft::engine {
namespace {

std::string to_string(RunOutcome outcome) {
  switch (outcome) {
    case RunOutcome::done:
      return "done";
    case RunOutcome::interrupted:
      return "interrupted";
    case RunOutcome::failed:
      break;
  }
  return "failed";
}

/// null for no frames.
nlohmann::ordered_json json_of(const std::vector<double>& series) {
  return series.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(series);
}

nlohmann::ordered_json json_of(const EnergySeries& e) {
  return {{"kinetic", json_of(e.kinetic)},     {"elastic", json_of(e.elastic)},
          {"bending", json_of(e.bending)},     {"gravitational", json_of(e.gravitational)},
          {"work_pins", json_of(e.work_pins)}, {"work_shapes", json_of(e.work_shapes)},
          {"work_wind", json_of(e.work_wind)}, {"work_hands", json_of(e.work_hands)},
          {"left_over", json_of(e.left_over)}};
}

/// Seconds of the whole run; counts per frame, except for the longest list of the run.
nlohmann::ordered_json json_of(const WorkTimes& w, int frames) {
  const auto per_frame = [&](std::size_t count) { return static_cast<double>(count) / std::max(1, frames); };
  return {{"seconds",
           {{"total", w.total},
            {"lists", w.lists},
            {"narrow_phase", w.narrow_phase},
            {"rows", w.rows},
            {"set_up", w.set_up},
            {"product", w.product},
            {"v_cycle", w.v_cycle},
            {"projection", w.projection},
            {"ccd", w.ccd},
            {"retries", w.retries}}},
          {"pairs_listed", w.pairs_listed},
          {"per_frame",
           {{"looks", per_frame(w.looks)},
            {"pairs_tested", per_frame(w.pairs_tested)},
            {"active", per_frame(w.active)},
            {"list_renewals", per_frame(w.list_renewals)}}}};
}

}  // namespace

std::string to_json(const RunReport& r) {
  nlohmann::ordered_json problems = nlohmann::ordered_json::array();
  for (const RunProblem& p : r.problems)
    problems.push_back(
        {{"code", to_string(p.code)}, {"frames", p.frames}, {"value", p.value}, {"sentence", p.message}});
  const nlohmann::ordered_json null = nullptr;
  const auto or_null = [](const auto& value) {
    return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
  };
  nlohmann::ordered_json json = {
      {"scene", r.scene},
      {"integrator", r.integrator},
      {"version", r.version},
      {"outcome", to_string(r.outcome)},
      {"failure", r.failure.empty() ? null : nlohmann::ordered_json(r.failure)},
      {"particles", r.particles},
      {"triangles", r.triangles},
      {"springs", r.springs},
      {"frames", r.frames},
      {"seconds_simulated", r.seconds_simulated},
      {"threads", r.threads},
      {"ms_per_frame", {{"median", r.ms_per_frame_median}, {"p95", r.ms_per_frame_p95}}},
      {"cpu_ms_per_frame", r.cpu_ms_per_frame},
      {"untangle_seconds", r.untangle_seconds},
      {"max_strain", r.max_strain},
      {"min_strain", r.min_strain},
      {"mean_strain", r.mean_strain},
      {"max_stretch", json_of(r.max_stretch)},
      {"min_stretch", json_of(r.min_stretch)},
      {"penetration_max", or_null(r.penetration_max)},
      {"intersections", or_null(r.intersections)},
      {"passages", or_null(r.passages)},
      {"first_passage", r.first_passage.empty() ? null : nlohmann::ordered_json(r.first_passage)},
      {"infeasible", or_null(r.infeasible)},
      {"contact_hits", or_null(r.contact_hits)},
      {"contact_zones", or_null(r.contact_zones)},
      {"guard_events", or_null(r.guard_events)},
      {"divisions", r.divisions},
      {"torn", r.torn},
      {"retries", r.retries},
      {"faults", r.faults},
      {"newton_steps", r.newton_steps.empty() ? null : nlohmann::ordered_json(r.newton_steps)},
      {"cg_iterations", r.cg_iterations.empty() ? null : nlohmann::ordered_json(r.cg_iterations)},
      {"work", json_of(r.work, r.frames)},
      {"state_hash", r.state_hash},
      {"warnings", r.warnings},
      {"notes", r.notes},
      {"problems", problems},
      {"kinetic_energy", r.kinetic_energy},
      {"potential_energy", r.potential_energy},
      {"energy", json_of(r.energy)},
      {"lowest_y", r.lowest_y},
  };
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void write_report(const std::filesystem::path& file, const RunReport& report) {
  write_file(file, to_json(report));
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(values.size())));
  return values[std::clamp<std::size_t>(rank, 1, values.size()) - 1];
}

}  // namespace weft::engine
