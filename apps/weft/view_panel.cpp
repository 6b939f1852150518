#include "view_panel.h"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>

#include "view_plots.h"
#include "view_tuning.h"
#include "viewer.h"
#include "weft/parameters.h"

namespace weft::engine::app {
namespace {

constexpr float kMargin = 14, kWidth = 292, kQuestionWidth = 400;  // [pixels]
const ImVec4 kInk(0.10f, 0.12f, 0.16f, 1), kPale(0.36f, 0.40f, 0.46f, 1), kAlarm(0.72f, 0.14f, 0.05f, 1);

const SpringModel kModels[] = {SpringModel::simplified, SpringModel::alternating, SpringModel::basic};

float scale() { return ImGui::GetIO().FontGlobalScale; }

/// Description of the last control's parameter, while the pointer is on it.
void explain(const char* key) {
  if (ImGui::IsItemHovered()) show_tooltip(find_parameter(key).description);
}

/// Dear ImGui's default font has no Greek.
std::string without_greek(std::string words) {
  constexpr std::string_view kSigma = "Σ";
  for (std::size_t at; (at = words.find(kSigma)) != std::string::npos;)
    words.replace(at, kSigma.size(), " sum ");
  return words;
}

void say(const ImVec4& color, const std::string& words) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + (kWidth - 24) * scale());
  ImGui::TextUnformatted(without_greek(words).c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

bool draw_button(Viewer& viewer, const char* words, const std::string& name, float share) {
  const float width = (ImGui::GetContentRegionAvail().x + ImGui::GetStyle().ItemSpacing.x) * share -
                      ImGui::GetStyle().ItemSpacing.x;
  const bool is_pressed = ImGui::Button(words, {width, 0});
  note_control(viewer, name);
  return is_pressed;
}

void draw_play_buttons(Viewer& viewer) {
  if (draw_button(viewer, viewer.is_playing() ? "Pause" : "Play", "play", 1 / 3.0f)) viewer.toggle_play();
  ImGui::SameLine();
  if (draw_button(viewer, "Step", "step", 1 / 2.0f)) viewer.step(1);
  ImGui::SameLine();
  if (draw_button(viewer, "Reset", "reset", 1)) viewer.reset();
}

/// Of a run.
void draw_frames(Viewer& viewer) {
  ViewSide& side = viewer.side(0);
  const PlayHead& head = *side.head();
  if (draw_button(viewer, viewer.is_playing() ? "Pause" : "Play", "play", 1 / 2.0f)) viewer.toggle_play();
  ImGui::SameLine();
  if (draw_button(viewer, "<", "back", 1 / 2.0f)) viewer.step_frame(true);
  ImGui::SameLine();
  if (draw_button(viewer, ">", "on", 1)) viewer.step_frame(false);
  int frame = head.frame();
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderInt("##frame", &frame, 0, side.num_frames() - 1, "frame %d", ImGuiSliderFlags_AlwaysClamp))
    viewer.seek(frame);
  note_control(viewer, "frame");
  bool loops = head.loops;
  if (ImGui::Checkbox("loop", &loops)) viewer.toggle_loop();
  note_control(viewer, "loop");
  ImGui::SameLine(kWidth * 0.52f * scale());
  ImGui::TextUnformatted(fmt::format("time {:.2f} s", head.frame() / head.frames_per_second).c_str());
  ImGui::TextUnformatted(
      fmt::format("frames 0 to {}, {:.4g} per second", side.num_frames() - 1, head.frames_per_second)
          .c_str());
}

void draw_integrator(Viewer& viewer, int s) {
  const std::string now = viewer.side(s).status()->integrator;
  ImGui::SetNextItemWidth(kWidth * 0.58f * scale());
  if (ImGui::BeginCombo("integrator", now.c_str())) {
    for (const std::string_view name : integrator_names()) {
      if (ImGui::Selectable(std::string(name).c_str(), name == now))
        viewer.set_integrator(s, std::string(name));
      note_control(viewer, "integrator " + std::to_string(s) + " " + std::string(name));
    }
    ImGui::EndCombo();
  } else {
    explain("solver.integrator");
    note_control(viewer, "integrator " + std::to_string(s));
  }
}

/// Results and warnings.
void draw_status(const LiveStatus& s) {
  ImGui::TextUnformatted(fmt::format("{:.2f} ms per step", s.ms_per_step).c_str());
  ImGui::SameLine(kWidth * 0.52f * scale());
  ImGui::TextUnformatted(fmt::format("{:.0f} steps/s", s.steps_per_second).c_str());
  ImGui::TextUnformatted(fmt::format("{:.2f} s per second", s.simulated_per_second).c_str());
  ImGui::SameLine(kWidth * 0.52f * scale());
  ImGui::TextUnformatted(fmt::format("time {:.2f} s", s.time).c_str());
  if (s.too_heavy)
    say(kAlarm, fmt::format("Slower than real time by a factor of {:.3g}", 1 / s.simulated_per_second));
  if (!s.failure.empty()) say(kAlarm, "Paused: " + s.failure);
  for (const RunProblem& problem : s.problems)
    say(kAlarm, fmt::format("{}: {}", to_string(problem.code), problem.message));
  for (const std::string& warning : s.warnings) say(kAlarm, warning);
}

void draw_model(Viewer& viewer) {
  const std::string now = viewer.side(0).status()->model;
  ImGui::SetNextItemWidth(kWidth * 0.58f * scale());
  if (ImGui::BeginCombo("springs", now.c_str())) {
    for (const SpringModel model : kModels) {
      if (now != "mesh" && ImGui::Selectable(std::string(to_string(model)).c_str(), to_string(model) == now))
        viewer.set_model(model);
    }
    ImGui::EndCombo();
  } else {
    explain("cloth.model");
  }
}

void draw_wind(Viewer& viewer) {
  Eigen::Vector3f wind = viewer.side(0).status()->wind.velocity.cast<float>();
  bool has_changed = false;
  const char* names[] = {"wind x", "wind y", "wind z"};
  constexpr float kStrongest = kStrongestWind;
  for (int axis = 0; axis < 3; ++axis) {
    ImGui::SetNextItemWidth(kWidth * 0.58f * scale());
    has_changed |= ImGui::SliderFloat(names[axis], &wind[axis], -kStrongest, kStrongest, "%.1f m/s");
    if (ImGui::IsItemDeactivated()) viewer.settle_edits();
    explain("wind.velocity");
    note_control(viewer, names[axis]);
  }
  if (has_changed) viewer.set_wind(wind.cast<double>());
}

/// The steps that can be shown again, and the speed of play.
void draw_time(Viewer& viewer) {
  const LiveStatus& status = *viewer.side(0).status();
  int step = static_cast<int>(status.steps);
  ImGui::SetNextItemWidth(kWidth * 0.58f * scale());
  if (ImGui::SliderInt("past", &step, static_cast<int>(status.first_step), static_cast<int>(status.last_step),
                       "step %d", ImGuiSliderFlags_AlwaysClamp))
    viewer.seek_step(step);
  if (ImGui::IsItemHovered())
    show_tooltip("The last ten seconds. Play goes on from the step that is shown, with the present numbers.");
  note_control(viewer, "past");
  float speed = static_cast<float>(viewer.speed());
  ImGui::SetNextItemWidth(kWidth * 0.58f * scale());
  if (ImGui::SliderFloat("speed", &speed, 0.05f, 1, "%.2f", ImGuiSliderFlags_AlwaysClamp))
    viewer.set_speed(speed);
  if (ImGui::IsItemHovered()) show_tooltip("Slow motion: simulated seconds per second, at most.");
  note_control(viewer, "speed");
}

/// `anchor`: the point of the box that is at (x, y), as shares of its size.
void begin_box(const char* name, float x, float y, float width, const ImVec2& anchor = {0, 0}) {
  ImGui::SetNextWindowPos({x, y}, ImGuiCond_Always, anchor);
  ImGui::SetNextWindowSizeConstraints({width, 0}, {width, FLT_MAX});
  ImGui::Begin(name, nullptr, kBoxFlags);
}

void draw_colors(Viewer& viewer) {
  const std::string now = viewer.look.color ? label_of(*viewer.look.color).name : "its own";
  ImGui::SetNextItemWidth(kWidth * 0.58f * scale());
  const bool is_open = ImGui::BeginCombo("colour", now.c_str());
  if (!is_open) note_control(viewer, "colour");
  if (is_open) {
    if (ImGui::Selectable("its own", !viewer.look.color)) viewer.set_color({});
    for (const ParticleValue value : kParticleValues) {
      if (ImGui::Selectable(label_of(value).name.c_str(), viewer.look.color == value))
        viewer.set_color(value);
      note_control(viewer, "colour " + label_of(value).word);
    }
    ImGui::EndCombo();
  }
  if (viewer.look.color && !viewer.side(0).no_color().empty()) say(kAlarm, viewer.side(0).no_color());
}

/// What the exact checker has found, last.
void draw_findings(const ViewSide& side) {
  if (!side.findings()) return say(kPale, "The checker is at work");
  const FrameFindings& found = *side.findings();
  say(found.intersections > 0 ? kAlarm : kPale,
      fmt::format("{} crossing pairs of triangles", found.intersections));
  if (!found.sentences.empty()) say(kAlarm, found.sentences[0]);
  if (found.penetration && *found.penetration > 0)
    say(kAlarm, fmt::format("{:.3g} mm deep: {}", 1000 * *found.penetration, found.deepest));
}

/// What is drawn besides the cloth.
void draw_look(Viewer& viewer) {
  const bool is_open = ImGui::CollapsingHeader("look");
  note_control(viewer, "look");
  if (!is_open) return;
  draw_colors(viewer);
  ViewLook& look = viewer.look;
  struct Switch {
    const char* name;
    bool ViewLook::*value;
    const char* meaning;
  };
  const Switch switches[] = {
      {"springs", &ViewLook::springs, "Particles and springs in place of the cloth (G)"},
      {"yarns", &ViewLook::yarns, "Warp blue and weft orange, of fabrics: as long as they are stretched (Y)"},
      {"seams", &ViewLook::seams, "Edges where the texture coordinates break (E)"},
      {"pins", &ViewLook::pins, "Pinned particles (X)"},
      {"contacts", &ViewLook::contacts, "Forces of contacts on cloth, in the last step (F)"},
      {"checker", &ViewLook::checker, "Crossings of triangles, found by the exact checker (K)"},
  };
  int column = 0;
  for (const auto& [name, value, meaning] : switches) {
    if (!viewer.can_show(value)) continue;
    if (column++ % 2 == 1) ImGui::SameLine(kWidth * 0.5f * scale());
    ImGui::Checkbox(name, &(look.*value));
    if (ImGui::IsItemHovered()) show_tooltip(meaning);
    note_control(viewer, name);
  }
  if (look.contacts && viewer.side(0).largest_force() > 0)
    say(kPale, fmt::format("longest arrows: {:g} N", viewer.scales().force));
  else if (look.contacts)
    say(kPale, "no contacts measured: they are from the next step on");
  for (int s = 0; look.checker && s < viewer.num_sides(); ++s) draw_findings(viewer.side(s));
}

void draw_record(Viewer& viewer) {
  begin_box("record", 2 * kMargin + kWidth * scale(), ImGui::GetIO().DisplaySize.y - kMargin,
            kWidth * scale(), {0, 1});
  if (const Recording* recording = viewer.recording()) {
    ImGui::ProgressBar(static_cast<float>(recording->drawn()) / static_cast<float>(recording->wanted()),
                       {-1, 0},
                       fmt::format("{} of {} pictures", recording->drawn(), recording->wanted()).c_str());
    if (draw_button(viewer, "Finish", "record finish", 1 / 2.0f)) viewer.stop_recording(true);
    ImGui::SameLine();
    if (draw_button(viewer, "Cancel", "record cancel", 1)) viewer.stop_recording(false);
    return ImGui::End();
  }
  RecordRequest& request = viewer.record_request;
  edit_text("file", request.file);
  if (ImGui::IsItemHovered())
    show_tooltip("A .mp4, .webp, .gif or .glb file; frame_####.png: numbered pictures");
  note_control(viewer, "record file");
  edit_text("size", request.size);
  note_control(viewer, "record size");
  ImGui::InputInt("frames", &request.frames);
  request.frames = std::clamp(request.frames, 0, 1000000);
  note_control(viewer, "record frames");
  ImGui::InputInt("every", &request.every);
  request.every = std::clamp(request.every, 1, 1000);
  if (ImGui::IsItemHovered()) show_tooltip("1: every frame; 2: every second one");
  note_control(viewer, "record every");
  if (draw_button(viewer, "Record", "record", 1)) viewer.record();
  ImGui::End();
}

void draw_view(Viewer& viewer) {
  draw_look(viewer);
  if (ImGui::SmallButton("record (V)")) viewer.toggle_record();
  note_control(viewer, "recorder");
  ImGui::SameLine();
  if (ImGui::SmallButton("help (H)")) viewer.toggle_help();
  note_control(viewer, "help");
  if (viewer.is_simulation()) {
    if (ImGui::SmallButton("numbers (N)")) viewer.toggle_numbers();
    note_control(viewer, "numbers");
    ImGui::SameLine();
  }
  if (viewer.side(0).measured()) {
    if (ImGui::SmallButton("plots (T)")) viewer.toggle_plots();
    note_control(viewer, "plots");
    ImGui::SameLine();
  }
  if (ImGui::SmallButton("scenes")) viewer.open_gallery();
  note_control(viewer, "gallery");
}

/// Centred at the lower edge of a side, with two sides.
void draw_side_box(Viewer& viewer, int s) {
  const WindowPart part = viewer.part(s);
  const float x = static_cast<float>(part.x) + 0.5f * static_cast<float>(part.size.width);
  begin_box(("side " + std::to_string(s)).c_str(), x, static_cast<float>(part.size.height) - kMargin,
            kWidth * scale(), {0.5f, 1});
  ImGui::TextUnformatted(viewer.compared()[s].c_str());
  draw_integrator(viewer, s);
  draw_status(*viewer.side(s).status());
  ImGui::End();
}

/// Of a simulation.
void draw_controls(Viewer& viewer) {
  draw_play_buttons(viewer);
  if (viewer.num_sides() == 1) {
    draw_status(*viewer.side(0).status());
    ImGui::Separator();
    draw_integrator(viewer, 0);
  }
  draw_model(viewer);
  ImGui::Separator();
  draw_wind(viewer);
  ImGui::Separator();
  draw_time(viewer);
}

void draw_main_box(Viewer& viewer) {
  if (viewer.wants_focus()) ImGui::SetNextWindowFocus();
  begin_box("weft", kMargin, kMargin, kWidth * scale());
  ImGui::TextUnformatted(viewer.side(0).title().c_str());
  ImGui::Separator();
  viewer.is_simulation() ? draw_controls(viewer) : draw_frames(viewer);
  ImGui::Separator();
  draw_view(viewer);
  say(kPale, fmt::format("{:.0f} ms per picture{}", viewer.picture_ms(),
                         viewer.window().is_software() ? ", software rendering" : ""));
  if (!viewer.message().empty()) say(kPale, viewer.message());
  ImGui::End();
}

enum class KeyOf { both, simulation, run };

struct KeyHelp {
  const char* key;
  const char* meaning;
  KeyOf of = KeyOf::both;
};

constexpr KeyHelp kHelp[] = {
    {"left drag on cloth", "grab, pull, release", KeyOf::simulation},
    {"left drag on a body", "move it; let go on the move: throw it", KeyOf::simulation},
    {"ctrl+left drag on a body", "turn it", KeyOf::simulation},
    {"Delete", "remove the body that was clicked", KeyOf::simulation},
    {"ctrl+click on cloth", "pin, unpin a particle", KeyOf::simulation},
    {"ctrl+drag, +shift", "pin, unpin in a box", KeyOf::simulation},
    {"right click on cloth", "probe; elsewhere: no probe"},
    {"left or right drag", "rotate the view"},
    {"middle or shift drag", "pan the view"},
    {"wheel", "zoom"},
    {"space", "play, pause"},
    {". or S", "one step", KeyOf::simulation},
    {"right arrow, shift+S", "one frame", KeyOf::simulation},
    {"right, left arrow", "one frame on, back", KeyOf::run},
    {"R", "restart"},
    {"L", "loop, or stop at the end", KeyOf::run},
    {"I, shift+I", "next, previous integrator", KeyOf::simulation},
    {"M", "next spring model", KeyOf::simulation},
    {"W", "wind: drag the arrow's tip", KeyOf::simulation},
    {"1, 2, 3, 4, 5", "colour: its own, strain, shear, speed, contact", KeyOf::simulation},
    {"1, 2, 3, 4", "colour: its own, strain, shear, speed", KeyOf::run},
    {"G, Y, E, X", "springs, yarns, seams, pins"},
    {"F", "contact forces", KeyOf::simulation},
    {"K", "the exact checker"},
    {"V", "record"},
    {"N", "numbers: fabric, solver, colliders", KeyOf::simulation},
    {"T", "plots over time"},
    {"ctrl+Z, ctrl+Y", "undo, redo a change of numbers", KeyOf::simulation},
    {"ctrl+S", "save the scene", KeyOf::simulation},
    {"ctrl+R", "read the file again"},
    {"ctrl+O", "other scenes"},
    {"ctrl+plus, ctrl+minus", "larger, smaller text"},
    {"F6", "the keyboard in the panels: arrows, space, Enter; Esc: out"},
    {"ctrl+Tab", "meanwhile: the next panel"},
    {"C", "reset the view"},
    {"P", "save the picture as PNG"},
    {"F12", "write the report (--report)"},
    {"H, F1", "this help"},
    {"Q, Esc", "close"},
};

void draw_help(bool is_simulation) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::Begin("keys", nullptr, kBoxFlags);
  if (ImGui::BeginTable("keyboard shortcuts", 2, ImGuiTableFlags_SizingFixedFit)) {
    for (const auto& [key, meaning, of] : kHelp) {
      if (of == (is_simulation ? KeyOf::run : KeyOf::simulation)) continue;
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(key);
      ImGui::TableNextColumn();
      ImGui::TextColored(kPale, "  %s", meaning);
    }
    ImGui::EndTable();
  }
  ImGui::End();
}

void draw_divider(const Viewer& viewer) {
  for (int s = 1; s < viewer.num_sides(); ++s) {
    const float x = static_cast<float>(viewer.part(s).x);
    ImGui::GetBackgroundDrawList()->AddLine({x, 0}, {x, ImGui::GetIO().DisplaySize.y},
                                            IM_COL32(255, 255, 255, 200), 2 * scale());
  }
}

}  // namespace

void set_panel_style(double window_scale) {
  const float s = static_cast<float>(window_scale);
  ImGuiStyle& style = ImGui::GetStyle();
  style = ImGuiStyle();
  ImGui::StyleColorsLight();
  style.WindowRounding = 8;
  style.FrameRounding = style.GrabRounding = style.PopupRounding = 5;
  style.WindowPadding = {12, 10};
  style.FramePadding = {8, 4};
  style.ItemSpacing = {8, 6};
  style.WindowBorderSize = 0;
  style.GrabMinSize = 14;
  style.Colors[ImGuiCol_Text] = kInk;
  style.Colors[ImGuiCol_WindowBg] = {0.97f, 0.975f, 0.98f, 0.86f};
  style.Colors[ImGuiCol_PopupBg] = {0.98f, 0.985f, 0.99f, 0.98f};
  style.Colors[ImGuiCol_FrameBg] = style.Colors[ImGuiCol_Button] = {0.80f, 0.83f, 0.87f, 0.75f};
  style.Colors[ImGuiCol_FrameBgHovered] = style.Colors[ImGuiCol_ButtonHovered] = {0.72f, 0.77f, 0.83f, 0.9f};
  style.Colors[ImGuiCol_FrameBgActive] = style.Colors[ImGuiCol_ButtonActive] = {0.62f, 0.70f, 0.79f, 1};
  style.Colors[ImGuiCol_SliderGrab] = {0.24f, 0.38f, 0.56f, 0.9f};
  style.Colors[ImGuiCol_SliderGrabActive] = style.Colors[ImGuiCol_CheckMark] = {0.12f, 0.28f, 0.50f, 1};
  style.ScaleAllSizes(s);
  ImGui::GetIO().FontGlobalScale = s;
}

void draw_panel(Viewer& viewer) {
  draw_divider(viewer);
  draw_main_box(viewer);
  for (int s = 0; viewer.num_sides() > 1 && s < viewer.num_sides(); ++s) draw_side_box(viewer, s);
  if (viewer.is_simulation() && viewer.shows_numbers()) draw_tuning(viewer);
  if (viewer.side(0).measured() && viewer.shows_plots()) draw_plots(viewer);
  if (viewer.shows_record()) draw_record(viewer);
  if (viewer.shows_help()) draw_help(viewer.is_simulation());
}

void draw_question(Viewer& viewer) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  begin_box("question", screen.x / 2, screen.y / 2, kQuestionWidth * scale(), {0.5f, 0.5f});
  ImGui::SetWindowFocus();
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(("Save the changes as " + viewer.save_as() + "?").c_str());
  ImGui::PopTextWrapPos();
  if (draw_button(viewer, "Save (S)", "answer save", 1 / 3.0f)) viewer.answer(Viewer::Answer::save);
  ImGui::SameLine();
  if (draw_button(viewer, "Discard (D)", "answer discard", 1 / 2.0f)) viewer.answer(Viewer::Answer::discard);
  ImGui::SameLine();
  if (draw_button(viewer, "Cancel (Esc)", "answer cancel", 1)) viewer.answer(Viewer::Answer::cancel);
  ImGui::End();
}

void note_control(Viewer& viewer, const std::string& name) {
  const ImVec2 a = ImGui::GetItemRectMin(), b = ImGui::GetItemRectMax();
  viewer.controls[name] = {a.x, a.y, b.x, b.y};
}

void show_tooltip(const std::string& words) {
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(kWidth * scale());
  ImGui::TextUnformatted(without_greek(words).c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void show_alarm(const std::string& words) {
  ImGui::PushStyleColor(ImGuiCol_Text, kAlarm);
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(without_greek(words).c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

bool edit_text(const char* id, std::string& text) {
  const auto grow = [](ImGuiInputTextCallbackData* data) {
    std::string& grown = *static_cast<std::string*>(data->UserData);
    if (data->EventFlag == ImGuiInputTextFlags_CallbackResize) {
      grown.resize(static_cast<std::size_t>(data->BufTextLen));
      data->Buf = grown.data();
    }
    return 0;
  };
  return ImGui::InputText(id, text.data(), text.capacity() + 1,
                          ImGuiInputTextFlags_CallbackResize | ImGuiInputTextFlags_EnterReturnsTrue, grow,
                          &text);
}

}  // namespace weft::engine::app
