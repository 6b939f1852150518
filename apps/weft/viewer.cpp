#include "viewer.h"

#include <algorithm>
#include <thread>

#include "apps/common/progress.h"
#include "recent_files.h"
#include "view_overlays.h"
#include "view_panel.h"
#include "view_report.h"
#include "weft/error.h"
#include "weft/scene/tunables.h"
#include "weft/scene/unsupported.h"

namespace weft::engine::app {
namespace {

constexpr double kWheelFactor = 0.88;           // of the distance, per click
constexpr double kRoom = 1.1;                   // extra camera distance, for grabs and swings [1]
constexpr double kSoftwareInterval = 1 / 30.0;  // between pictures with software OpenGL [s]
constexpr double kIdle = 0.05;                  // poll interval of an unchanged window [s]
constexpr int kUnchanged = 4;                   // pictures before drawing waits for a change [1]
constexpr double kRest = 0.3;                   // without a change before the best picture is drawn [s]
constexpr double kWindow = 1;                   // averaging window of pictures per second [s]
constexpr double kTextStep = 1.25, kMaxTextScale = 3;  // of the text's size [1]
constexpr double kTallScreen = 1080;                   // height that the panels are made for [pixels]
constexpr double kNewShare = 0.1;  // weight of the last picture in the mean of their times [1]

const SpringModel kModels[] = {SpringModel::simplified, SpringModel::alternating, SpringModel::basic};

double seconds(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

}  // namespace

Viewer::Viewer(Opened opened, const ViewRequest& request, const ViewOptions& options)
    : request_(request),
      options_(options),
      window_({.title = "Weft", .size = options.size}),
      renderer_(window_.make_device()),
      quality_(window_.is_software()) {
  scale_text(1);
  opened.sides.empty() ? open_gallery() : show(std::move(opened));
}

void Viewer::run() {
  const WindowEvents events = make_events();
  drawn_at_ = changed_at_ = second_began_ = Clock::now();
  while (!interrupted()) {
    if (window_.is_closing()) {
      if (may_close_ || !edits_ || !edits_->is_changed() || options_.frames > 0) break;
      refuse_close();
    }
    if (wait()) continue;
    window_.begin_frame(events);
    update();
    draw();
    finish_frame();
  }
  write_report();
}

/// A side whose step has failed pauses itself; the other one then pauses too.
void Viewer::update() {
  hands_.update();
  measure();
  bool has_stopped = false;
  for (const auto& side : sides_) {
    if (!side->update()) continue;
    has_news_ = true;
    has_stopped |= !side->is_going();
  }
  if (look.checker) {
    for (const auto& side : sides_) has_news_ |= side->check();
  }
  update_scales();
  if (has_stopped && is_playing_) toggle_play();
  if (!recording_) return;
  has_news_ = true;
  try {
    recording_->advance(renderer_);
    if (recording_->is_done()) stop_recording(true);
  } catch (const InputError& error) {
    recording_.reset();
    say(error.what());
  }
}

/// What the look and the probe need.
void Viewer::measure() {
  const LiveInstruments wanted{
      .color = look.color, .contacts = look.contacts, .yarns = look.yarns, .probe = probe_};
  if (wanted == instruments_) return;
  instruments_ = wanted;
  for (const auto& side : sides_) side->measure(wanted);
}

void Viewer::update_scales() {
  double value = 0, force = 0;
  for (const auto& side : sides_) {
    value = std::max(value, side->largest_value());
    force = std::max(force, side->largest_force());
  }
  color_scale_.update(value);
  force_scale_.update(force);
  scales_ = {.color = color_scale_.end(), .force = force_scale_.end()};
}

// ---- Files ----------------------------------------------------------------------------------------------

void Viewer::show(Opened opened) {
  recording_.reset();
  hands_.forget();
  probe_.reset();
  instruments_ = {};
  color_scale_.forget();
  force_scale_.forget();
  sides_ = std::move(opened.sides);
  compared_ = std::move(opened.compared);
  edits_.reset();
  if (opened.scene) edits_.emplace(std::move(*opened.scene), opened.file);
  shown_file_ = opened.file.string();
  save_as_ = opened.file.stem().string() + "_tuned.toml";
  remember_file(opened.file);
  window_.set_title("Weft: " + sides_[0]->title());
  message_.clear();
  record_request.file = opened.file.stem().string() + ".mp4";
  record_request.frames = is_simulation() ? edits_->now().num_frames() : sides_[0]->num_frames() - 1;
  is_playing_ = true;
  if (is_simulation()) set_speed(speed_);
  for (const auto& side : sides_) side->play();
  frame_scene();
}

/// What is shown goes on existing until the other file has proved good.
void Viewer::open(const std::string& file) {
  leave([this, file] {
    try {
      ViewRequest request{.scene = file, .threads = request_.threads};
      Opened opened = open_view(request);
      if (!opened.fabric) return show(std::move(opened));
      if (!edits_) throw InputError(file + " is a fabric: open a scene first, then drop it on its cloth");
      SceneDesc next = edits_->now();
      for (ClothSceneDesc& cloth : next.cloths) take_fabric(*opened.fabric, cloth);
      settle_tunables(next);
      if (!edit(std::move(next), "fabric file")) return;
      settle_edits();
      say("fabric " + opened.fabric->name);
    } catch (const InputError& error) {
      say(error.what());
    }
  });
}

void Viewer::open_gallery() {
  leave([this] {
    try {
      gallery_ = make_gallery();
      recording_.reset();
      hands_.forget();
      window_.navigate(false);
      sides_.clear();
      edits_.reset();
      message_.clear();
      window_.set_title("Weft");
      has_news_ = true;
    } catch (const InputError& error) {
      say(error.what());
    }
  });
}

void Viewer::reload() {
  if (!shown_file_.empty() && !sides_.empty()) open(shown_file_);
}

/// Does it now, or after the user's answer.
void Viewer::leave(std::function<void()> then) {
  has_news_ = true;
  if (edits_ && edits_->is_changed())
    after_question_ = std::move(then);
  else
    then();
}

void Viewer::refuse_close() {
  window_.keep_open();
  leave([this] {
    may_close_ = true;
    window_.close();
  });
}

void Viewer::answer(Answer answer) {
  const std::function<void()> then = std::move(after_question_);
  after_question_ = nullptr;
  has_news_ = true;
  if (answer == Answer::save) save_scene();
  if (answer == Answer::cancel || (answer == Answer::save && edits_->is_changed())) return;
  then();
}

// ---- Edits ----------------------------------------------------------------------------------------------

bool Viewer::edit(SceneDesc next, const std::string& what) {
  const std::string& integrator = next.solver.integrator;
  if (const auto unsupported = find_unsupported(next, integrator); !unsupported.empty()) {
    say(integrator + ' ' + unsupported.front().sentence);
    return false;
  }
  edits_->edit(std::move(next), what);
  apply_edits();
  return true;
}

void Viewer::settle_edits() {
  if (edits_) edits_->settle();
}

void Viewer::undo() {
  if (!edits_) return;
  hands_.stop();
  edits_->undo();
  apply_edits();
}

void Viewer::redo() {
  if (!edits_) return;
  hands_.stop();
  edits_->redo();
  apply_edits();
}

/// Of two sides each keeps what is compared: its integrator or its fabric.
void Viewer::apply_edits() {
  has_news_ = true;
  for (int s = 0; s < num_sides(); ++s) {
    SceneDesc scene = edits_->now();
    if (num_sides() > 1) {
      take_variant(compared_[s], scene);
      scene.solver.integrator = sides_[s]->status()->integrator;
    }
    sides_[s]->live()->change(std::move(scene));
  }
}

void Viewer::save_scene() {
  if (!edits_) return;
  try {
    edits_->save(save_as_);
    remember_file(save_as_);
    say("written " + save_as_);
  } catch (const InputError& error) {
    say(error.what());
  }
}

void Viewer::seek_step(std::int64_t step) {
  if (refuse_while_recording()) return;
  is_playing_ = false;
  for (const auto& side : sides_) side->live()->seek(step);
}

void Viewer::set_speed(double speed) {
  speed_ = speed;
  for (const auto& side : sides_) side->live()->set_speed(speed);
}

// ---- User input -----------------------------------------------------------------------------------------

void Viewer::toggle_play() {
  if (refuse_while_recording()) return;
  is_playing_ = !is_playing_;
  for (const auto& side : sides_) {
    is_playing_ ? side->play() : side->pause();
  }
}

void Viewer::step(int count) {
  if (refuse_while_recording()) return;
  is_playing_ = false;
  for (const auto& side : sides_) side->step(count);
}

void Viewer::step_frame(bool backwards) {
  if ((backwards && is_simulation()) || refuse_while_recording()) return;
  is_playing_ = false;
  for (const auto& side : sides_) side->step_frame(backwards);
}

void Viewer::reset() {
  if (refuse_while_recording()) return;
  hands_.stop();
  for (const auto& side : sides_) side->reset();
}

void Viewer::seek(int frame) {
  if (refuse_while_recording()) return;
  for (const auto& side : sides_) side->head()->seek(frame, side->num_frames());
}

void Viewer::toggle_loop() {
  for (const auto& side : sides_) {
    if (PlayHead* head = side->head()) head->loops = !head->loops;
  }
}

void Viewer::set_integrator(int side, const std::string& name) {
  sides_[side]->live()->set_integrator(name);
  if (num_sides() > 1 || !find_unsupported(edits_->now(), name).empty()) return;
  SceneDesc next = edits_->now();
  next.solver.integrator = name;
  edits_->edit(std::move(next), "integrator");
  settle_edits();
}

void Viewer::cycle_integrator(bool backwards) {
  if (!is_simulation()) return;
  const int s = hands_.side();
  const auto& names = integrator_names();
  const auto now = std::find(names.begin(), names.end(), sides_[s]->status()->integrator) - names.begin();
  const auto count = static_cast<std::ptrdiff_t>(names.size());
  for (std::ptrdiff_t k = 1; k < count; ++k) {
    const std::string name(names[(now + (backwards ? count - k : k)) % count]);
    if (find_unsupported(edits_->now(), name).empty()) return set_integrator(s, name);
  }
}

void Viewer::set_model(SpringModel model) {
  SceneDesc next = edits_->now();
  for (ClothSceneDesc& cloth : next.cloths) {
    if (std::holds_alternative<Grid>(cloth.shape)) cloth.model = model;
  }
  edit(std::move(next), "model");
  settle_edits();
}

void Viewer::cycle_model() {
  if (!is_simulation()) return;
  const auto& cloths = edits_->now().cloths;
  const auto grid = std::find_if(cloths.begin(), cloths.end(), [](const ClothSceneDesc& cloth) {
    return std::holds_alternative<Grid>(cloth.shape);
  });
  if (grid == cloths.end()) return say("mesh cloth: its edges are the only spring model");
  const auto known = std::find(std::begin(kModels), std::end(kModels), grid->model);
  set_model(kModels[(known - std::begin(kModels) + 1) % std::size(kModels)]);
}

void Viewer::set_wind(const Vec3& velocity) {
  SceneDesc next = edits_->now();
  set_steady_wind(velocity, next);
  edit(std::move(next), "wind");
}

void Viewer::set_color(std::optional<ParticleValue> value) {
  look.color = value;
  color_scale_.forget();
  has_news_ = true;
}

void Viewer::set_probe(const std::optional<ClothPoint>& point) {
  probe_ = point;
  has_news_ = true;
}

double Viewer::frames_per_second() const {
  return is_simulation() ? edits_->now().fps : sides_[0]->head()->frames_per_second;
}

bool Viewer::compares_fabrics() const { return !std::ranges::all_of(compared_, is_integrator); }

// ---- Recording ------------------------------------------------------------------------------------------

void Viewer::record() {
  if (recording_ || shows_gallery()) return;
  if (is_playing_) toggle_play();
  try {
    recording_ = std::make_unique<Recording>(*this, record_request);
  } catch (const InputError& error) {
    say(error.what());
  }
}

void Viewer::stop_recording(bool keeps) {
  if (!recording_) return;
  const std::unique_ptr<Recording> ended = std::move(recording_);
  if (!keeps) return say("the recording is cancelled");
  try {
    if (!ended->is_done()) ended->finish();
    say(ended->drawn() > 0 ? "written " + ended->file() : "nothing is recorded: there was no frame to draw");
  } catch (const InputError& error) {
    say(error.what());
  }
}

bool Viewer::refuse_while_recording() {
  if (recording_) say("the recording goes from frame to frame: finish or cancel it first (V)");
  return recording_ != nullptr;
}

void Viewer::frame_scene() {
  camera_ = frame_points({}, sides_[0]->reach(), part(0).size.aspect());
  camera_.zoom(kRoom);
}

WindowEvents Viewer::make_events() {
  const auto news = [this] { has_news_ = true; };
  return {.on_key = [=, this](int key, Modifiers held) { news(), on_key(key, held); },
          .on_press =
              [=, this](MouseButton b, double x, double y, Modifiers held) {
                news();
                if (!shows_gallery()) hands_.press(b, x, y, held);
              },
          .on_release = [=, this](MouseButton b) { news(), hands_.release(b); },
          .on_move = [=, this](double x, double y) { news(), hands_.move(x, y); },
          .on_wheel =
              [=, this](double clicks) {
                news();
                camera_.zoom(std::pow(kWheelFactor, clicks));
              },
          .on_drop =
              [=, this](const std::vector<std::string>& files) {
                news();
                if (!files.empty()) open(files.front());
              }};
}

void Viewer::on_key(int key, Modifiers held) {
  if (key == kKeyReport) return write_report();
  if (is_asking()) {
    if (key == 'S') answer(Answer::save);
    if (key == 'D') answer(Answer::discard);
    if (key == kKeyEscape) answer(Answer::cancel);
    return;
  }
  if (!shows_gallery() && (key == kKeyPanels || (key == kKeyEscape && window_.is_navigating())))
    return toggle_navigation();
  if (key == 'Q' || key == kKeyEscape) return window_.close();
  if (held.control) {
    if (key == 'Z') held.shift ? redo() : undo();
    if (key == 'Y') redo();
    if (key == 'S') save_scene();
    if (key == 'R') reload();
    if (key == 'O') open_gallery();
    if (key == '=') scale_text(kTextStep);
    if (key == '-') scale_text(1 / kTextStep);
    return;
  }
  if (shows_gallery() || on_look_key(key)) return;
  switch (key) {
    case ' ':
      return toggle_play();
    case '.':
      return step(1);
    case 'S':
      return held.shift ? step_frame(false) : step(1);
    case kKeyRight:
      return step_frame(false);
    case kKeyLeft:
      return step_frame(true);
    case 'L':
      return toggle_loop();
    case 'R':
      return reset();
    case 'I':
      return cycle_integrator(held.shift);
    case 'M':
      return cycle_model();
    case 'V':
      return toggle_record();
    case kKeyDelete:
      if (is_simulation()) hands_.remove_body();
      return;
    case 'C':
      return frame_scene();
    case 'P':
      return save_picture();
    case 'N':
      return toggle_numbers();
    case 'T':
      return toggle_plots();
    case 'H':
    case kKeyHelp:
      return toggle_help();
    default:
      break;
  }
}

/// Keys of what is shown. False: another key.
bool Viewer::on_look_key(int key) {
  if (key == '1') return set_color({}), true;
  if (key >= '2' && key < '2' + static_cast<int>(kParticleValues.size()))
    return set_color(kParticleValues[key - '2']), true;
  if (key == 'K') return look.checker = !look.checker, true;
  if (key == 'W' && is_simulation()) return hands_.toggle_wind(), true;
  for (const auto& [letter, shown] : {std::pair('G', &ViewLook::springs), std::pair('Y', &ViewLook::yarns),
                                      std::pair('E', &ViewLook::seams), std::pair('X', &ViewLook::pins),
                                      std::pair('F', &ViewLook::contacts)}) {
    if (key == letter && can_show(shown)) return look.*shown = !(look.*shown), true;
  }
  return false;
}

bool Viewer::can_show(bool ViewLook::*shown) const {
  if (shown == &ViewLook::checker) return true;
  return shown == &ViewLook::contacts ? is_simulation() : sides_[0]->measured() != nullptr;
}

void Viewer::scale_text(double factor) {
  text_scale_ = std::clamp(factor * text_scale_, 1 / kMaxTextScale, kMaxTextScale);
  const double tall =
      std::round(window_.size().height / kTallScreen);  // whose scale the system does not tell
  set_panel_style(text_scale_ * std::max(window_.scale(), tall));
}

void Viewer::toggle_navigation() {
  window_.navigate(!window_.is_navigating());
  wants_focus_ = window_.is_navigating();
}

// ---- Layout ---------------------------------------------------------------------------------------------

WindowPart Viewer::part(int side) const {
  const PictureSize size = window_.size();
  const int left = side * size.width / std::max(num_sides(), 1),
            right = (side + 1) * size.width / std::max(num_sides(), 1);
  return {left, 0, {std::max(right - left, 1), size.height}};
}

int Viewer::side_at(double x) const {
  const double share = x / window_.size().width;
  return std::clamp(static_cast<int>(share * num_sides()), 0, num_sides() - 1);
}

Ray Viewer::ray_at(int side, double x, double y) const {
  const WindowPart where = part(side);
  return camera_.ray(x - where.x, y, where.size);
}

// ---- Drawing ---------------------------------------------------------------------------------------------

/// Pictures follow each other at the screen's rate, and slower with software OpenGL. True: nothing has changed,
/// and the last picture stays.
bool Viewer::wait() {
  if (window_.is_software()) {
    const double rest = kSoftwareInterval - seconds(Clock::now() - drawn_at_);
    if (rest > 0) std::this_thread::sleep_for(std::chrono::duration<double>(rest));
  }
  const bool is_at_rest = is_playing_ ? unchanged_ >= kUnchanged : is_best_;
  if (!is_at_rest || options_.frames > 0 || window_.is_typing()) return false;
  if (window_.wait_for_event(is_playing_ ? kSoftwareInterval : kIdle)) {
    has_news_ = true;
    return false;
  }
  update();
  return !has_news_;
}

void Viewer::draw() {
  drawn_at_ = Clock::now();
  unchanged_ = has_news_ ? 0 : unchanged_ + 1;
  if (has_news_) changed_at_ = drawn_at_;
  has_news_ = false;
  is_best_ = !is_playing_ && seconds(drawn_at_ - changed_at_) > kRest;
  const bool is_still = is_best_ || wants_picture_;
  renderer_.set_settings(quality_.settings(is_still));
  for (int s = 0; s < num_sides(); ++s) {
    const WindowPart where = part(s);
    Picture picture = sides_[s]->draw(camera_, look, scales_, false);
    hands_.mark(s, picture);
    renderer_.show(picture, quality_.scaled(where.size, is_still), where);
  }
  const Clock::time_point drawn = Clock::now();
  controls.clear();
  if (!shows_gallery()) draw_overlays(*this);
  shows_gallery() ? draw_gallery(*this, gallery_) : draw_panel(*this);
  if (is_asking()) draw_question(*this);
  const double ms = 1000 * seconds(Clock::now() - drawn);
  panel_ms_ += kNewShare * (ms - panel_ms_);
}

void Viewer::finish_frame() {
  const bool is_moving = unchanged_ == 0 && !wants_picture_;
  if (wants_picture_) {
    wants_picture_ = false;
    const Image image = window_.end_frame_and_read();
    const std::filesystem::path file = name_of_next_picture();
    try {
      write_image(file, image);
      pictures_.push_back(file.string());
      say("written " + file.string());
    } catch (const InputError& error) {
      say(error.what());
    }
  } else {
    window_.end_frame();
  }
  const Clock::time_point now = Clock::now();
  if (is_moving) {
    const double ms = 1000 * seconds(now - drawn_at_);
    quality_.add(ms);
    picture_ms_ += kNewShare * (ms - picture_ms_);
  }
  ++drawn_in_second_;
  if (const double span = seconds(now - second_began_); span > kWindow) {
    drawn_per_second_ = static_cast<double>(drawn_in_second_) / span;
    drawn_in_second_ = 0;
    second_began_ = now;
  }
  if (++drawn_frames_ == options_.frames) window_.close();
}

void Viewer::write_report() {
  if (options_.report.empty()) return;
  try {
    write_view_report(options_.report, *this);
  } catch (const InputError& error) {
    say(error.what());
  }
}

void Viewer::say(const std::string& message) {
  message_ = message;
  has_news_ = true;
}

}  // namespace weft::engine::app
