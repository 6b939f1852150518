#include "view_tuning.h"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "view_panel.h"
#include "viewer.h"
#include "weft/scene/tunables.h"

namespace weft::engine::app {
namespace {

constexpr float kMargin = 14, kValueShare = 0.4f;  // [pixels], [1]
constexpr float kSpeed = 0.01f;                    // change per pixel of a drag, as a share [1]
constexpr const char* kQualities[] = {"fast", "normal", "high"};

std::string last_part(const std::string& key) { return key.substr(key.rfind('.') + 1); }

/// Meaning, unit, range and default.
std::string explain(const Tunable& t) {
  const Parameter& p = *t.parameter;
  std::string text = t.key + (p.unit.empty() ? "" : " [" + p.unit + "]") + "\n" + p.description;
  if (p.min || p.max)
    text += fmt::format("\nRange: {}{}{}",
                        p.min ? fmt::format("{}{:g}", p.excludes_min ? "above " : "from ", *p.min) : "",
                        p.min && p.max ? " " : "", p.max ? fmt::format("to {:g}", *p.max) : "");
  if (!p.default_value.empty()) text += "\nDefault: " + p.default_value;
  return text;
}

/// A control for a value; true if it has changed it.
struct Control {
  const Parameter& parameter;
  const char* id;

  /// Values that Dear ImGui keeps a drag within.
  double least() const { return parameter.min.value_or(-1e12) + (parameter.excludes_min ? 1e-12 : 0); }
  double most() const { return parameter.max.value_or(1e12); }

  bool operator()(double* value) const {
    const double low = least(), high = most();
    const float speed = std::max(kSpeed * static_cast<float>(std::abs(*value)), 1e-7f);
    return ImGui::DragScalar(id, ImGuiDataType_Double, value, speed, &low, &high, "%.5g",
                             ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoRoundToFormat);
  }
  bool operator()(int* value) const {
    const int low = static_cast<int>(std::max(least(), 0.0)), high = static_cast<int>(std::min(most(), 1e6));
    return ImGui::DragScalar(id, ImGuiDataType_S32, value, 0.05f, &low, &high, "%d",
                             ImGuiSliderFlags_AlwaysClamp);
  }
  bool operator()(bool* value) const { return ImGui::Checkbox(id, value); }
  bool operator()(Vec3* value) const {
    const double low = least(), high = most();
    return ImGui::DragScalarN(id, ImGuiDataType_Double, value->data(), 3, kSpeed, &low, &high, "%.3g",
                              ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoRoundToFormat);
  }
  bool operator()(NewtonQuality* value) const {
    int index = static_cast<int>(*value);
    const bool has_changed = ImGui::Combo(id, &index, kQualities, 3);
    *value = static_cast<NewtonQuality>(index);
    return has_changed;
  }
};

void draw_value(Viewer& viewer, const Tunable& t, SceneDesc& scene) {
  const float scale = ImGui::GetIO().FontGlobalScale;
  const std::string id = "##" + t.key;
  ImGui::SetNextItemWidth(kNumbersWidth * kValueShare * scale);
  const bool has_changed = std::visit(Control{*t.parameter, id.c_str()}, t.value);
  const bool is_done = ImGui::IsItemDeactivated();
  if (ImGui::IsItemHovered() && !ImGui::IsItemActive()) show_tooltip(explain(t));
  note_control(viewer, t.key);
  ImGui::SameLine();
  const std::string& unit = t.parameter->unit;
  ImGui::TextUnformatted((last_part(t.key) + (unit.empty() ? "" : " [" + unit + "]")).c_str());
  if (has_changed) {
    settle_tunables(scene);
    viewer.edit(scene, t.key);
  }
  if (is_done) viewer.settle_edits();
}

void draw_presets(Viewer& viewer, int c, SceneDesc& scene) {
  ClothSceneDesc& cloth = scene.cloths[c];
  const std::string name = cloth.fabric ? cloth.fabric->name : "springs", id = fmt::format("fabric##{}", c);
  ImGui::SetNextItemWidth(kNumbersWidth * kValueShare * ImGui::GetIO().FontGlobalScale);
  const bool is_open = ImGui::BeginCombo(id.c_str(), name.c_str());
  if (!is_open) note_control(viewer, fmt::format("fabric {}", c));
  if (!is_open) return;
  for (const FabricPreset& preset : fabric_presets()) {
    if (ImGui::Selectable(preset.name.c_str(), preset.name == name)) {
      take_fabric(preset, cloth);
      settle_tunables(scene);
      viewer.edit(scene, "fabric");
      viewer.settle_edits();
    }
    if (ImGui::IsItemHovered()) show_tooltip(preset.title);
    note_control(viewer, fmt::format("fabric {} {}", c, preset.name));
  }
  ImGui::EndCombo();
}

void draw_bodies(Viewer& viewer) {
  constexpr std::pair<const char*, NewCollider> kKinds[] = {{"+ ball", NewCollider::ball},
                                                            {"+ box", NewCollider::box},
                                                            {"+ capsule", NewCollider::capsule},
                                                            {"+ floor", NewCollider::floor}};
  for (const auto& [name, kind] : kKinds) {
    if (kind != NewCollider::ball) ImGui::SameLine();
    if (ImGui::Button(name)) viewer.hands().add_body(kind);
    note_control(viewer, name);
  }
  const std::string& touched = viewer.hands().touched();
  if (ImGui::Button(touched.empty() ? "remove" : ("remove " + touched + "###remove").c_str()))
    viewer.hands().remove_body();
  if (ImGui::IsItemHovered()) show_tooltip("The body that was clicked (Delete)");
  note_control(viewer, "remove");
}

void draw_file(Viewer& viewer) {
  if (ImGui::Button("Undo")) viewer.undo();
  note_control(viewer, "undo");
  ImGui::SameLine();
  if (ImGui::Button("Redo")) viewer.redo();
  note_control(viewer, "redo");
  ImGui::SameLine();
  if (ImGui::Button("Save scene")) viewer.save_scene();
  note_control(viewer, "save");
  ImGui::SameLine();
  ImGui::TextUnformatted(viewer.edits()->is_changed() ? "changed" : "");
  ImGui::SetNextItemWidth(-1);
  edit_text("##file", viewer.save_as());
  note_control(viewer, "file");
}

}  // namespace

void draw_tuning(Viewer& viewer) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float width = kNumbersWidth * ImGui::GetIO().FontGlobalScale;
  ImGui::SetNextWindowPos({screen.x - kMargin, kMargin}, ImGuiCond_Always, {1, 0});
  ImGui::SetNextWindowSizeConstraints({width, 0}, {width, screen.y - 2 * kMargin});
  ImGui::Begin("numbers", nullptr,
               ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_AlwaysAutoResize |
                   ImGuiWindowFlags_NoSavedSettings);
  draw_file(viewer);
  const std::vector<std::string>& waiting = viewer.side(0).status()->keys_for_restart;
  if (!waiting.empty()) {
    std::string keys;
    for (const std::string& key : waiting) keys += (keys.empty() ? "" : ", ") + key;
    show_alarm("Applied at the next restart (R): " + keys);
  }
  if (viewer.compares_fabrics())
    show_alarm("Fabrics are compared: each side keeps its own, without changes here.");
  draw_bodies(viewer);
  SceneDesc scene = viewer.edits()->now();
  int number = 0;  // names of colliders may be equal
  for (const TunableGroup& group : list_tunables(scene)) {
    const std::string label = fmt::format("{}##{}", group.title, number++);
    if (!ImGui::CollapsingHeader(label.c_str(), group.cloth == 0 ? ImGuiTreeNodeFlags_DefaultOpen : 0)) {
      note_control(viewer, "group " + group.title);
      continue;
    }
    note_control(viewer, "group " + group.title);
    for (const Tunable& t : group.values) draw_value(viewer, t, scene);
    if (group.cloth >= 0) draw_presets(viewer, group.cloth, scene);
  }
  ImGui::End();
}

}  // namespace weft::engine::app
