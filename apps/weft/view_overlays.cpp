#include "view_overlays.h"

#include <fmt/core.h>
#include <imgui.h>

#include "view_panel.h"
#include "viewer.h"
#include "weft/render/color_map.h"
#include "weft/render/legend.h"

namespace weft::engine::app {
namespace {

constexpr float kMargin = 14, kLegendWidth = 260, kLegendHeight = 14;  // [pixels]
constexpr int kColors = 64;                                            // of the legend
constexpr double kLeastForce = 1e-6;                                   // with a direction that is shown [N]
constexpr ImU32 kWind = IM_COL32(20, 90, 160, 255), kBoxLine = IM_COL32(20, 20, 20, 255),
                kBoxFill = IM_COL32(20, 90, 160, 40), kPaper = IM_COL32(248, 249, 250, 220);

float scale() { return ImGui::GetIO().FontGlobalScale; }

ImVec2 at(const Eigen::Vector2d& pixel, const WindowPart& part) {
  return {static_cast<float>(pixel.x()) + static_cast<float>(part.x), static_cast<float>(pixel.y())};
}

/// Colours with round numbers and the unit, in the lower right corner; beside plots and numbers in the middle.
void draw_color_legend(Viewer& viewer) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const bool is_beside = viewer.shows_plots() || viewer.shows_numbers();
  ImGui::SetNextWindowPos({is_beside ? 0.5f * screen.x : screen.x - kMargin, screen.y - kMargin},
                          ImGuiCond_Always, {is_beside ? 0.5f : 1, 1});
  ImGui::Begin("legend", nullptr, kBoxFlags | ImGuiWindowFlags_NoInputs);
  ImGui::TextUnformatted(label_of(*viewer.look.color).text().c_str());
  const float width = kLegendWidth * scale(), height = kLegendHeight * scale();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  for (int k = 0; k < kColors; ++k) {
    const auto color = map_color((k + 0.5) / kColors);
    const float left = corner.x + width * static_cast<float>(k) / kColors;
    list.AddRectFilled(
        {left, corner.y}, {left + width / kColors + 1, corner.y + height},
        ImGui::ColorConvertFloat4ToU32(
            {static_cast<float>(color[0]), static_cast<float>(color[1]), static_cast<float>(color[2]), 1}));
  }
  const double end = viewer.scales().color;
  for (const double tick : find_ticks({0, end})) {
    const std::string words = fmt::format("{:g}", tick);
    const float x = corner.x + width * static_cast<float>(tick / end),
                text = ImGui::CalcTextSize(words.c_str()).x;
    list.AddLine({x, corner.y + height}, {x, corner.y + height + 4 * scale()}, kBoxLine, scale());
    list.AddText(
        {std::clamp(x - text / 2, corner.x, corner.x + width - text), corner.y + height + 5 * scale()},
        kBoxLine, words.c_str());
  }
  ImGui::Dummy({width, height + 6 * scale() + ImGui::GetTextLineHeight()});
  note_control(viewer, "legend");
  ImGui::End();
}

std::string describe(const ProbeReading& reading) {
  std::string words = fmt::format("{}, triangle {}, particle {}{}\n", reading.cloth, reading.triangle,
                                  reading.particle, reading.is_pinned ? " (pinned)" : "");
  words +=
      fmt::format("at {:.4f} {:.4f} {:.4f} m\n", reading.point.x(), reading.point.y(), reading.point.z());
  if (reading.mass == 0) return words;
  words += fmt::format("speed {:.4g} m/s, mass {:.4g} g\n", reading.velocity.norm(), 1000 * reading.mass);
  if (reading.yarns)
    words += fmt::format("warp {:+.3g} %, weft {:+.3g} %, shear {:.3g} deg\n", reading.yarns->warp_strain(),
                         reading.yarns->weft_strain(), reading.yarns->shear());
  if (!reading.contact) return words;
  const double force = reading.contact->norm();
  words += fmt::format("contact {:.4g} N", force);
  if (force > kLeastForce)
    words += fmt::format(" along {:.2f} {:.2f} {:.2f}", reading.contact->x() / force,
                         reading.contact->y() / force, reading.contact->z() / force);
  return words;
}

void draw_probe(Viewer& viewer, int s) {
  const std::optional<ProbeReading> reading = viewer.side(s).probe();
  if (!reading) return;
  const WindowPart part = viewer.part(s);
  const auto pixel = viewer.camera().pixel(reading->point, part.size);
  if (!pixel) return;
  const ImVec2 point = at(*pixel, part);
  ImGui::GetBackgroundDrawList()->AddCircle(point, 6 * scale(), kBoxLine, 0, 2 * scale());
  ImGui::SetNextWindowPos({point.x + 12 * scale(), point.y + 12 * scale()});
  ImGui::Begin(fmt::format("probe {}", s).c_str(), nullptr, kBoxFlags | ImGuiWindowFlags_NoInputs);
  ImGui::TextUnformatted(describe(*reading).c_str());
  ImGui::End();
}

void draw_wind(Viewer& viewer, int s) {
  const WindowPart part = viewer.part(s);
  const auto foot = viewer.camera().pixel(viewer.hands().wind_foot(), part.size),
             tip = viewer.camera().pixel(viewer.hands().wind_tip(), part.size);
  if (!foot || !tip) return;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ImVec2 a = at(*foot, part), b = at(*tip, part);
  list.AddLine(a, b, kWind, 4 * scale());
  list.AddCircleFilled(a, 4 * scale(), kWind);
  list.AddCircleFilled(b, 8 * scale(), kWind);
  const std::string words = fmt::format("wind {:.1f} m/s", viewer.side(0).status()->wind.velocity.norm());
  const ImVec2 text(b.x + 14 * scale(), b.y - 8 * scale()), size = ImGui::CalcTextSize(words.c_str());
  const float edge = 4 * scale();
  list.AddRectFilled({text.x - edge, text.y - edge}, {text.x + size.x + edge, text.y + size.y + edge}, kPaper,
                     edge);
  list.AddText(text, kWind, words.c_str());
  viewer.controls[fmt::format("wind tip {}", s)] = {b.x - 1, b.y - 1, b.x + 1, b.y + 1};
}

}  // namespace

void draw_overlays(Viewer& viewer) {
  for (int s = 0; s < viewer.num_sides(); ++s) {
    draw_probe(viewer, s);
    if (viewer.is_simulation() && viewer.hands().shows_wind()) draw_wind(viewer, s);
  }
  if (viewer.look.color && viewer.side(0).no_color().empty()) draw_color_legend(viewer);
  if (const auto box = viewer.hands().box()) {
    const Eigen::Vector2f low = box->min().cast<float>(), high = box->max().cast<float>();
    const ImVec2 a(low.x(), low.y()), b(high.x(), high.y());
    ImGui::GetForegroundDrawList()->AddRectFilled(a, b, kBoxFill);
    ImGui::GetForegroundDrawList()->AddRect(a, b, kBoxLine, 0, 0, scale());
  }
}

}  // namespace weft::engine::app
