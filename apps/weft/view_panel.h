#pragma once
/// Controls over the picture.

#include <imgui.h>

#include <string>

namespace weft::engine::app {

class Viewer;

/// Colours and sizes of all controls; `scale` from Window::scale.
void set_panel_style(double scale);

/// Call within a frame of the viewer's window.
void draw_panel(Viewer& viewer);

/// The question before changes are lost.
void draw_question(Viewer& viewer);

// Parts that all panels share.

inline constexpr ImGuiWindowFlags kBoxFlags =
    ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
    ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings;

void note_control(Viewer& viewer, const std::string& name);  // records the place of the last control
void show_tooltip(const std::string& words);
void show_alarm(const std::string& words);
bool edit_text(const char* id, std::string& text);  // true: ended by Enter

}  // namespace weft::engine::app
