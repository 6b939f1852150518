#include "view_plots.h"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "view_panel.h"
#include "view_scale.h"
#include "view_tuning.h"
#include "viewer.h"

namespace weft::engine::app {
namespace {

constexpr float kWidth = 330, kHeight = 86, kAxis = 46, kMargin = 14;  // [pixels]
constexpr ImU32 kLine = IM_COL32(90, 98, 110, 255), kGrid = IM_COL32(0, 0, 0, 26);

struct Series {
  const char* name;
  ImU32 color;  // distinct for colour-blind people too: M. Okabe and K. Ito, 2008
  std::function<double(const LiveSample&)> value;
};

struct Plot {
  const char* title;
  const char* unit;
  std::vector<Series> series;
  bool is_stacked = false;   // areas on each other, else lines
  bool is_of_frames = true;  // measured once per frame, else at every step
  bool is_of_runs = true;    // known of the frames of a run
};

const std::vector<Plot>& plots() {
  constexpr double kMs = 1000;
  constexpr ImU32 kBlue = IM_COL32(0, 114, 178, 255), kOrange = IM_COL32(230, 159, 0, 255),
                  kGreen = IM_COL32(0, 158, 115, 255), kRed = IM_COL32(213, 94, 0, 255),
                  kSky = IM_COL32(86, 180, 233, 255), kPink = IM_COL32(204, 121, 167, 255);
  using S = const LiveSample&;
  static const std::vector<Plot> kPlots = {
      {.title = "work per step",
       .unit = "ms",
       .series = {{"pair lists", kSky, [](S s) { return kMs * s.work.lists; }},
                  {"distances", kBlue, [](S s) { return kMs * s.work.narrow_phase; }},
                  {"contact in the solve", kPink,
                   [](S s) { return kMs * (s.work.rows + s.work.product + s.work.set_up); }},
                  {"preconditioner", kGreen, [](S s) { return kMs * s.work.v_cycle; }},
                  {"projection, CCD", kRed, [](S s) { return kMs * (s.work.projection + s.work.ccd); }},
                  {"cloth and rest", kOrange,
                   [](S s) { return kMs * std::max(s.work.total - s.work.kinds(), 0.0); }}},
       .is_stacked = true,
       .is_of_frames = false,
       .is_of_runs = false},
      {.title = "largest strain",
       .unit = "%",
       .series = {{"yarn", kRed, [](S s) { return 100 * s.strain; }}}},
      {.title = "energy",
       .unit = "J",
       .series = {{"kinetic", kBlue, [](S s) { return s.energies.kinetic; }},
                  {"elastic", kRed, [](S s) { return s.energies.elastic; }},
                  {"bending", kGreen, [](S s) { return s.energies.bending; }}}},
      {.title = "contacts",
       .unit = "1",
       .series = {{"with a force", kBlue, [](S s) { return static_cast<double>(s.contacts); }}},
       .is_of_frames = false,
       .is_of_runs = false},
      {.title = "iterations",
       .unit = "1",
       .series = {{"linear (CG)", kBlue, [](S s) { return static_cast<double>(s.linear_iterations); }},
                  {"nonlinear", kOrange, [](S s) { return static_cast<double>(s.iterations); }}},
       .is_of_frames = false},
      {.title = "residual of CG",
       .unit = "%",
       .series = {{"largest of the step", kRed, [](S s) { return 100 * s.residual; }}},
       .is_of_frames = false,
       .is_of_runs = false}};
  return kPlots;
}

/// Values of each series at each sample; of stacked ones the sums with those below.
std::vector<std::vector<double>> evaluate(const Plot& plot, const std::deque<LiveSample>& samples) {
  std::vector<std::vector<double>> curves;
  for (const Series& series : plot.series) {
    std::vector<double> curve;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const double below = plot.is_stacked && !curves.empty() ? curves.back()[k] : 0;
      curve.push_back(series.value(samples[k]) + below);
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

/// Samples that a plot shows: energies and strain are measured once per frame.
std::deque<LiveSample> of_frames(const std::deque<LiveSample>& samples) {
  std::deque<LiveSample> measured;
  std::copy_if(samples.begin(), samples.end(), std::back_inserter(measured),
               [](const LiveSample& s) { return s.is_measured; });
  return measured;
}

/// The last sample up to a time; -1: none.
int find_sample(const std::deque<LiveSample>& samples, double time) {
  const auto after = std::ranges::upper_bound(samples, time, {}, &LiveSample::time);
  return static_cast<int>(after - samples.begin()) - 1;
}

void draw_legend(const Plot& plot, const std::deque<LiveSample>& samples, int at) {
  ImGui::TextUnformatted(fmt::format("{} [{}]", plot.title, plot.unit).c_str());
  for (const Series& series : plot.series) {
    const std::string value =
        at < 0 ? "" : fmt::format(" {:.3g}", series.value(samples[static_cast<std::size_t>(at)]));
    const std::string words = series.name + value;
    const float left = ImGui::GetItemRectMax().x + 12 - ImGui::GetWindowPos().x;
    if (left + ImGui::CalcTextSize(words.c_str()).x < ImGui::GetWindowWidth()) ImGui::SameLine();
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(series.color), "%s", words.c_str());
  }
}

/// `time`: of what is shown.
void draw_plot(Viewer& viewer, const Plot& plot, const std::deque<LiveSample>& samples, double time) {
  const float scale = ImGui::GetIO().FontGlobalScale;
  const std::vector<std::vector<double>> curves = evaluate(plot, samples);
  double top = 0;
  for (const auto& curve : curves) {
    for (const double v : curve) top = std::max(top, v);
  }
  top = round_up(top);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 size(kWidth * scale, kHeight * scale);
  const ImVec2 low(corner.x + kAxis * scale, corner.y),
      high(corner.x + size.x - 8 * scale, corner.y + size.y - 16 * scale);
  ImGui::InvisibleButton(plot.title, size);
  note_control(viewer, std::string("plot ") + plot.title);
  ImDrawList& out = *ImGui::GetWindowDrawList();
  const double from = samples.empty() ? 0 : samples.front().time,
               to = samples.empty() ? 1 : samples.back().time;
  const double span = std::max(to - from, 1e-9);
  const auto x = [&](std::size_t k) {
    return low.x + static_cast<float>((samples[k].time - from) / span) * (high.x - low.x);
  };
  const auto y = [&](double v) { return high.y - static_cast<float>(v / top) * (high.y - low.y); };
  out.AddRectFilled(low, high, IM_COL32(255, 255, 255, 150));
  for (const double share : {0.0, 0.5, 1.0}) {
    const std::string mark = fmt::format("{:.3g}", share * top);
    out.AddLine({low.x, y(share * top)}, {high.x, y(share * top)}, kGrid);
    out.AddText({low.x - 5 * scale - ImGui::CalcTextSize(mark.c_str()).x, y(share * top) - 7 * scale}, kLine,
                mark.c_str());
  }
  for (const double share : {0.0, 1.0}) {
    const std::string mark = fmt::format("{:.2f} s", from + share * span);
    const float width = ImGui::CalcTextSize(mark.c_str()).x;
    out.AddText({low.x + static_cast<float>(share) * (high.x - low.x - width), high.y + 1}, kLine,
                mark.c_str());
  }
  for (std::size_t c = curves.size(); c-- > 0;) {
    for (std::size_t k = 1; k < samples.size(); ++k) {
      const float x0 = x(k - 1), x1 = x(k), y0 = y(curves[c][k - 1]), y1 = y(curves[c][k]);
      if (plot.is_stacked)
        out.AddQuadFilled({x0, high.y}, {x0, y0}, {x1, y1}, {x1, high.y}, plot.series[c].color);
      else
        out.AddLine({x0, y0}, {x1, y1}, plot.series[c].color, 1.5f * scale);
    }
  }
  int at = find_sample(samples, time);
  if (at >= 0)
    out.AddLine({x(static_cast<std::size_t>(at)), low.y}, {x(static_cast<std::size_t>(at)), high.y}, kGrid);
  if (ImGui::IsItemHovered() && !samples.empty()) {
    const float mouse = ImGui::GetIO().MousePos.x;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      if (std::abs(x(k) - mouse) < std::abs(x(static_cast<std::size_t>(at)) - mouse))
        at = static_cast<int>(k);
    }
    out.AddLine({x(static_cast<std::size_t>(at)), low.y}, {x(static_cast<std::size_t>(at)), high.y}, kLine);
  }
  draw_legend(plot, samples, at);
}

}  // namespace

void draw_plots(Viewer& viewer) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const std::deque<LiveSample>& steps = viewer.side(0).samples();
  const std::deque<LiveSample> frames = of_frames(steps);
  const float numbers =
      viewer.shows_numbers() ? (kNumbersWidth + kMargin) * ImGui::GetIO().FontGlobalScale : 0;
  ImGui::SetNextWindowPos({screen.x - kMargin - numbers, screen.y - kMargin}, ImGuiCond_Always, {1, 1});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {screen.x, screen.y - 2 * kMargin});
  ImGui::Begin("plots", nullptr,
               ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoTitleBar |
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings);
  for (const Plot& plot : plots()) {
    if (viewer.is_simulation() || plot.is_of_runs)
      draw_plot(viewer, plot, plot.is_of_frames ? frames : steps, viewer.side(0).time());
  }
  ImGui::End();
}

}  // namespace weft::engine::app
