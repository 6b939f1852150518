#pragma once
/// The window of `weft view`: display and user input.

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene_edits.h"
#include "view_command.h"
#include "view_gallery.h"
#include "view_hands.h"
#include "view_open.h"
#include "view_quality.h"
#include "view_record.h"
#include "view_scale.h"
#include "view_side.h"
#include "weft/render/renderer.h"
#include "weft/window/window.h"

namespace weft::engine::app {

struct ViewOptions {
  PictureSize size;
  std::filesystem::path report;  // JSON state of the window, written at the end and on F12; empty: none
  std::int64_t frames = 0;       // number to show before closing; 0: until the user closes it
};

class Viewer {
 public:
  /// `opened`: one or two simulations of one scene, or the frames of a run, at rest until run(); nothing: the
  /// gallery. Throws GraphicsError.
  Viewer(Opened opened, const ViewRequest& request, const ViewOptions& options);

  /// Runs until the window is closed.
  void run();

  /// Shows a file or a shipped scene instead; a fabric goes to the cloths of the scene. Mistakes in the file
  /// become the message, and what is shown stays. Asks first if there are changes to save.
  void open(const std::string& file);
  void open_gallery();
  void reload();  // the file, which was edited

  // Edits of the scene that is simulated.
  const std::optional<SceneEdits>& edits() const { return edits_; }  // empty: a run, or the gallery
  /// See SceneEdits. Returns whether the scene was taken: what its integrator does not support is said instead.
  bool edit(SceneDesc next, const std::string& what);
  void settle_edits();
  void undo();
  void redo();
  void save_scene();  // as save_as()
  std::string& save_as() { return save_as_; }

  // The question before changes are lost.
  enum class Answer { save, discard, cancel };
  bool is_asking() const { return static_cast<bool>(after_question_); }
  void answer(Answer answer);

  void seek_step(std::int64_t step);  // of a simulation, of the last ten seconds
  void set_speed(double speed);       // of play, as a share of real time [1]
  double speed() const { return speed_; }
  void toggle_numbers() { shows_numbers_ = !shows_numbers_; }
  void toggle_plots() { shows_plots_ = !shows_plots_; }
  bool shows_numbers() const { return shows_numbers_; }
  bool shows_plots() const { return shows_plots_; }
  bool shows_gallery() const { return sides_.empty(); }
  void ask_for_frame() { has_news_ = true; }
  std::uint64_t make_texture(const Image& image) { return window_.make_texture(image); }
  void say(const std::string& message);

  // Actions of the keys, the mouse and the panel.
  void toggle_play();
  void step(int count);
  void step_frame(bool backwards);
  void seek(int frame);  // of a run
  void toggle_loop();    // of a run
  void reset();
  void set_integrator(int side, const std::string& name);
  void cycle_integrator(bool backwards);  // of the side under the mouse
  void set_model(SpringModel model);
  void cycle_model();
  void set_wind(const Vec3& velocity);  // uniform and constant [m/s]
  void set_color(std::optional<ParticleValue> value);
  void set_probe(const std::optional<ClothPoint>& point);
  void toggle_record() { shows_record_ = !shows_record_; }
  void record();  // by record_request
  void stop_recording(bool keeps);
  void scale_text(double factor);
  void toggle_navigation();                                          // of the controls by the keyboard
  bool wants_focus() { return std::exchange(wants_focus_, false); }  // of the first panel, once
  void toggle_help() { shows_help_ = !shows_help_; }
  void frame_scene();  // the initial camera
  Camera& camera() { return camera_; }
  Hands& hands() { return hands_; }
  const Hands& hands() const { return hands_; }
  void save_picture() { wants_picture_ = true; }
  void write_report();

  // Data for the panel and the report.
  int num_sides() const { return static_cast<int>(sides_.size()); }
  ViewSide& side(int s) const { return *sides_[s]; }
  bool is_simulation() const {
    return !sides_.empty() && sides_[0]->live() != nullptr;
  }  // else frames of a run
  bool is_playing() const { return is_playing_; }
  /// Whether this switch of `look` has an effect: a run has no forces of contacts, and may have positions only.
  bool can_show(bool ViewLook::*shown) const;
  bool shows_record() const { return shows_record_; }
  const Recording* recording() const { return recording_.get(); }
  const ViewScales& scales() const { return scales_; }
  double frames_per_second() const;  // of the scene or the run
  bool shows_help() const { return shows_help_; }
  const Camera& camera() const { return camera_; }
  const Window& window() const { return window_; }
  int quality_level() const { return quality_.level(); }
  std::int64_t drawn_frames() const { return drawn_frames_; }
  double drawn_per_second() const { return drawn_per_second_; }
  double panel_ms() const { return panel_ms_; }      // to lay the panels out [ms]
  double picture_ms() const { return picture_ms_; }  // to draw and show one during motion [ms]
  const std::vector<std::string>& pictures() const { return pictures_; }
  const std::string& message() const { return message_; }
  WindowPart part(int side) const;  // part of the window of a side
  int side_at(double x) const;      // of a position in the window [pixels]
  Ray ray_at(int side, double x, double y) const;
  const std::vector<std::string>& compared() const { return compared_; }  // (num_sides) or empty
  bool compares_fabrics() const;

  ViewLook look;  // changed by keys and panel
  RecordRequest record_request;

  /// Rectangle of each control: left, top, right, bottom [pixels].
  std::map<std::string, std::array<double, 4>> controls;

 private:
  using Clock = std::chrono::steady_clock;

  void update();
  WindowEvents make_events();
  void on_key(int key, Modifiers held);
  bool on_look_key(int key);
  void measure();
  void update_scales();
  bool refuse_while_recording();
  void draw();
  void finish_frame();
  bool wait();
  void show(Opened opened);
  void leave(std::function<void()> then);
  void apply_edits();
  void refuse_close();

  std::vector<std::unique_ptr<ViewSide>> sides_;
  std::optional<SceneEdits> edits_;
  std::vector<std::string> compared_;
  std::string save_as_, shown_file_;
  std::function<void()> after_question_;
  Gallery gallery_;
  ViewRequest request_;
  ViewOptions options_;
  Window window_;
  Renderer renderer_;
  ViewQuality quality_;

  Camera camera_;
  bool is_playing_ = true, shows_help_ = false, wants_picture_ = false;
  bool shows_numbers_ = false, shows_plots_ = false, shows_record_ = false;
  bool wants_focus_ = false, may_close_ = false;  // although changes are not saved
  double speed_ = 1, text_scale_ = 1;

  Hands hands_{*this};
  std::unique_ptr<Recording> recording_;

  // What is measured and shown.
  LiveInstruments instruments_;
  std::optional<ClothPoint> probe_;
  RoundScale color_scale_, force_scale_;
  ViewScales scales_;

  // Drawing.
  bool has_news_ = true;  // changes since the last picture
  bool is_best_ = false;  // the last picture was the best of what is at rest
  int unchanged_ = 0;     // pictures since the last change
  Clock::time_point drawn_at_, changed_at_, second_began_;
  std::int64_t drawn_frames_ = 0, drawn_in_second_ = 0;
  double drawn_per_second_ = 0, picture_ms_ = 0, panel_ms_ = 0;
  std::vector<std::string> pictures_;
  std::string message_;
};

}  // namespace weft::engine::app
