#include "lab/comparisons/comparison.h"

#include <fmt/core.h>

#include <algorithm>

#include "weft/world/measures.h"

namespace weft::engine::lab {

Comparison::Comparison(const SectionOptions& options, const HungCloth& cloth, const Reference& reference)
    : options_(options), cloth_(cloth), reference_(reference) {
  table_.head = {"engine",           "setting",  "how the cloth is given",
                 "CPU ms per frame", "error, m", "worst strain, %"};
}

void Comparison::add(const MethodSettings& entry, const std::string& engine, const std::string& how,
                     const Make& make) {
  options_.report_progress(engine + ", " + entry.setting);
  add_row(engine, how, measure_method([&] { return make(entry, cloth_); }, entry, cloth_, reference_));
}

void Comparison::add(const Peer& peer) {
  for (const PeerSetting& setting : peer.settings) {
    const bool is_only = setting.solver.empty();
    const std::string method = is_only ? peer.engine : peer.engine + "'s " + setting.solver;
    options_.report_progress(method + ", " + setting.words);
    const auto run = run_peer({peer.interpreter, peer.script, setting.arguments},
                              cloth_.model->num_particles(), kComparedFrames);
    if (!run) return add_absence(peer.engine, "did not run; is it installed? (" + peer.install + ")");
    MethodResult result = evaluate(*run);
    result.method = method;
    result.setting = setting.words;
    add_row(is_only ? run->engine : run->engine + ", " + setting.solver, setting.how, result);
  }
}

void Comparison::add_absence(const std::string& engine, const std::string& why) {
  table_.rows.push_back({engine, "", why, "", "", ""});
}

void Comparison::add_row(const std::string& engine, const std::string& how, const MethodResult& result) {
  results_.push_back(result);
  std::vector<std::string> measured = {"diverges", "", ""};
  if (result.ok)
    measured = {fmt::format("{:.2f}", result.cpu_ms), fmt::format("{:.4f}", result.error),
                fmt::format("{:.1f}", 100 * result.strain)};
  table_.rows.push_back({engine, result.setting, how, measured[0], measured[1], measured[2]});
}

MethodResult Comparison::evaluate(const PeerRun& run) const {
  MethodResult result{.cpu_ms = run.cpu_ms};
  ClothState state = cloth_.state;
  for (int f = 0; f < kComparedFrames; ++f) {
    const std::vector<float>& x = run.frames[f];
    for (std::size_t i = 0; i < state.x.size(); ++i)
      state.set_position(i, {x[3 * i], x[3 * i + 1], x[3 * i + 2]});
    const double distance = distance_from(reference_.frames[f], state);
    result.ok = distance < kLargeError;
    if (!result.ok) return result;
    result.error += distance / kComparedFrames;
    result.strain = std::max(result.strain, compute_strain(*cloth_.model, state).max);
  }
  return result;
}

void Comparison::add_results(const std::vector<std::pair<std::string, std::string>>& figure_of_method,
                             Hypothesis& hypothesis) const {
  const auto find = [&](const std::string& method) {
    return find_time(method, results_, [](const MethodResult& r) { return r.error / kEqualError; });
  };
  std::string words;
  for (const auto& [method, figure] : figure_of_method) {
    const auto newton = find("newton"), time = find(method);
    if (!newton || !time) continue;
    hypothesis.found.metrics.push_back({figure, *time / *newton, "1", "> 1", 0});
    words += fmt::format("{}{} {:.1f}", words.empty() ? "" : ", ", method, *time / *newton);
  }
  if (!words.empty())
    hypothesis.text.push_back(fmt::format(
        "CPU time at an error of {} m, as a multiple of that of `newton`: {}.", kEqualError, words));
  hypothesis.found.tables.push_back(table_);
}

}  // namespace weft::engine::lab
