#include "view_gallery.h"

#include <imgui.h>

#include <algorithm>

#include "recent_files.h"
#include "view_panel.h"
#include "viewer.h"
#include "weft/error.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_reader.h"

namespace weft::engine::app {
namespace {

constexpr float kPictureWidth = 216, kPictureHeight = 135;  // [pixels]
constexpr int kLoadedPerFrame = 3;  // pictures, so that the first frame is there at once
constexpr ImGuiWindowFlags kWhole = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus;

void load_pictures(Viewer& viewer, Gallery& gallery) {
  int loaded = 0;
  for (GalleryEntry& entry : gallery.entries) {
    if (entry.is_loaded || loaded == kLoadedPerFrame) continue;
    entry.is_loaded = true;
    ++loaded;
    viewer.ask_for_frame();
    if (!std::filesystem::exists(entry.picture)) continue;
    try {
      entry.texture = viewer.make_texture(read_jpg(entry.picture));
    } catch (const InputError& error) {
      viewer.say(error.what());
    }
  }
}

/// The scene's own line, while the pointer is on it.
void describe(const GalleryEntry& entry) {
  if (!ImGui::IsItemHovered()) return;
  try {
    show_tooltip(read_scene(find_scene(entry.name)).description);
  } catch (const InputError& error) {
    show_tooltip(error.what());
  }
}

/// True if it is chosen.
bool draw_entry(Viewer& viewer, const GalleryEntry& entry, float scale) {
  const ImVec2 size(kPictureWidth * scale, kPictureHeight * scale);
  ImGui::PushID(entry.name.c_str());
  ImGui::BeginGroup();
  const bool is_chosen = entry.texture ? ImGui::ImageButton(reinterpret_cast<ImTextureID>(entry.texture),
                                                            size, {0, 0}, {1, 1}, 0)
                                       : ImGui::Button("no picture", size);
  note_control(viewer, "scene " + entry.name);
  describe(entry);
  ImGui::TextUnformatted(entry.name.c_str());
  ImGui::EndGroup();
  ImGui::PopID();
  return is_chosen;
}

}  // namespace

Gallery make_gallery() {
  Gallery gallery{.recent = read_recent_files()};
  for (const ShippedScene& scene : list_scenes()) {
    std::filesystem::path picture = scene.file;
    gallery.entries.push_back({scene.name, picture.replace_extension(".jpg")});
  }
  return gallery;
}

void draw_gallery(Viewer& viewer, Gallery& gallery) {
  load_pictures(viewer, gallery);
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float scale = ImGui::GetIO().FontGlobalScale;
  std::string chosen;
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize(screen);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
  ImGui::PushStyleColor(ImGuiCol_WindowBg, {0.95f, 0.955f, 0.965f, 1});
  ImGui::Begin("gallery", nullptr, kWhole);
  ImGui::TextUnformatted("Choose a scene, drop a file on the window, or type its path and Enter");
  ImGui::SetNextItemWidth(std::min(600 * scale, 0.6f * screen.x));
  if (edit_text("##path", gallery.path)) chosen = gallery.path;
  note_control(viewer, "path");
  ImGui::SameLine();
  if (ImGui::Button("Open")) chosen = gallery.path;
  note_control(viewer, "open");
  if (!viewer.message().empty()) show_alarm(viewer.message());
  for (const std::string& file : gallery.recent) {
    if (ImGui::SmallButton(file.c_str())) chosen = file;
    note_control(viewer, "recent " + file);
  }
  ImGui::Separator();
  ImGui::BeginChild("scenes");
  const float step = kPictureWidth * scale + ImGui::GetStyle().ItemSpacing.x;
  const int columns = std::max(1, static_cast<int>(ImGui::GetContentRegionAvail().x / step));
  for (std::size_t k = 0; k < gallery.entries.size(); ++k) {
    if (static_cast<int>(k) % columns != 0) ImGui::SameLine();
    if (draw_entry(viewer, gallery.entries[k], scale)) chosen = gallery.entries[k].name;
  }
  ImGui::EndChild();
  ImGui::End();
  ImGui::PopStyleColor();
  ImGui::PopStyleVar();
  if (!chosen.empty()) viewer.open(chosen);
}

}  // namespace weft::engine::app
