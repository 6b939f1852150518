#pragma once
/// What the window, or one of its two halves, shows: a simulation, or the frames of a run.

#include <chrono>
#include <deque>

#include "view_checker.h"
#include "weft/pictures/scene_picture.h"
#include "weft/render/pick.h"
#include "weft/run/live.h"
#include "weft/run/playback.h"

namespace weft::engine::app {

/// What is drawn besides the cloth itself.
struct ViewLook {
  std::optional<ParticleValue> color;  // of the cloth; empty: its fabric's
  bool springs = false;                // in place of the cloth
  bool yarns = false, seams = false, pins = false, contacts = false, checker = false;
};

/// Scales that all sides share, for comparisons.
struct ViewScales {
  double color = 1;  // value of the last colour; the first one is 0
  double force = 1;  // of the longest arrows [N]
};

/// What is under the mouse.
struct ViewHit {
  std::optional<ClothPoint> cloth;  // empty: no cloth
  int body = -1;                    // -1: no body
  Vec3 place = Vec3::Zero();        // [m]
};

class ViewSide {
 public:
  virtual ~ViewSide() = default;
  ViewSide(const ViewSide&) = delete;
  ViewSide& operator=(const ViewSide&) = delete;

  virtual const std::string& title() const = 0;
  virtual std::vector<Vec3> reach() const = 0;  // points to be in the picture [m]

  virtual void play() = 0;
  virtual void pause() = 0;
  virtual void step(int count) = 0;             // pauses, then makes so many steps; of a run frames
  virtual void step_frame(bool backwards) = 0;  // likewise a frame; a simulation has no way back
  virtual void reset() = 0;                     // to the start

  /// Takes the newest frame; false if there is none since the last call.
  virtual bool update() = 0;

  /// Whether it goes on by itself: false after a failed step, and at the end of a run that does not loop.
  virtual bool is_going() const = 0;

  virtual LiveSimulation* live() { return nullptr; }                  // null: frames of a run
  virtual const LiveStatus* status() const { return nullptr; }        // of live()
  virtual const LiveFrame* measured() const { return nullptr; }       // null: only positions are known
  const std::deque<LiveSample>& samples() const { return samples_; }  // by ascending time
  virtual double time() const = 0;                                    // of what is shown [s]
  virtual PlayHead* head() { return nullptr; }                        // null: a simulation
  virtual int num_frames() { return 0; }                              // of a run, with the start
  virtual int frame() const { return 0; }                             // of a run: the current one

  virtual void measure(const LiveInstruments& instruments) = 0;  // from the next frame on
  virtual std::optional<ProbeReading> probe() const = 0;         // of the measured point
  virtual std::string no_color() const = 0;  // why there are no values to colour by; empty: there are

  /// The current picture; `best`: smooth cloth with hems, as in files.
  Picture draw(const Camera& camera, const ViewLook& look, const ViewScales& scales, bool best) const;

  std::optional<ViewHit> pick(const Ray& ray) const;

  /// Starts the exact checker for the current frame when it has time; true: there are new findings.
  bool check() { return checker_.update(meshes_, frame_, num_updates_); }
  const std::optional<FrameFindings>& findings() const { return checker_.findings(); }

  const Animation& meshes() const { return meshes_; }  // without frames
  const AnimationFrame& current_frame() const { return frame_; }
  Vec3 position(int cloth, int vertex) const;       // [m]
  Eigen::AlignedBox3d box_of_body(int body) const;  // [m]
  double ground() const { return ground_; }         // height of the ground without a floor [m]
  double largest_value() const;                     // of the colours; 0 without
  double largest_force() const;                     // of contacts; 0 without [N]
  Vec3 center() const;                              // of the first cloth's particles [m]

 protected:
  ViewSide() = default;

  Animation meshes_;                                              // without frames
  AnimationFrame frame_;                                          // the current one
  std::vector<std::shared_ptr<const ClothTopology>> topologies_;  // (num_cloths) of measured()
  double ground_ = 0;             // height of the ground in scenes without a floor [m]
  std::int64_t num_updates_ = 0;  // of frame_
  std::deque<LiveSample> samples_;

 private:
  void add_pins(Picture& picture) const;
  void add_seams(Picture& picture) const;
  void add_yarns(Picture& picture) const;
  void add_contacts(const ViewScales& scales, Picture& picture) const;
  void add_crossings(Picture& picture) const;

  ViewChecker checker_;
};

/// A simulation in real time.
class LiveSide : public ViewSide {
 public:
  LiveSide(const SceneDesc& scene, int threads);

  const std::string& title() const override { return live_.scene().name; }
  std::vector<Vec3> reach() const override { return live_.reach(); }
  void play() override { live_.play(); }
  void pause() override { live_.pause(); }
  void step(int count) override { live_.step(count); }
  void step_frame(bool backwards) override;
  void reset() override { live_.reset(); }
  bool update() override;
  bool is_going() const override { return newest_.status.failure.empty(); }
  LiveSimulation* live() override { return &live_; }
  const LiveStatus* status() const override { return &newest_.status; }
  const LiveFrame* measured() const override { return &newest_; }
  double time() const override { return newest_.status.time; }
  void measure(const LiveInstruments& instruments) override { live_.measure(instruments); }
  std::optional<ProbeReading> probe() const override { return newest_.probe; }
  std::string no_color() const override { return newest_.no_color; }

 private:
  LiveSimulation live_;
  LiveFrame newest_;
  std::shared_ptr<const Animation> start_;  // of meshes_
};

/// The frames of a run, in their time.
class RunSide : public ViewSide {
 public:
  /// Throws InputError like open_frames_and_world().
  explicit RunSide(const std::filesystem::path& path);

  const std::string& title() const override { return title_; }
  std::vector<Vec3> reach() const override { return reach_; }
  void play() override { head_.play(num_frames()); }
  void pause() override { head_.is_playing = false; }
  void step(int count) override { head_.step(count, num_frames()); }
  void step_frame(bool backwards) override { step(backwards ? -1 : 1); }
  void reset() override { head_.seek(0, num_frames()); }
  bool update() override;
  bool is_going() const override { return head_.is_playing; }
  PlayHead* head() override { return &head_; }
  int num_frames() override { return run_.frames->num_frames(); }
  int frame() const override { return number_; }
  const LiveFrame* measured() const override { return run_.world ? &measured_ : nullptr; }
  double time() const override { return number_ / head_.frames_per_second; }
  void measure(const LiveInstruments& instruments) override;
  std::optional<ProbeReading> probe() const override;
  std::string no_color() const override;

 private:
  using Clock = std::chrono::steady_clock;

  void show(int frame);
  void show_world(int frame);

  FramesAndWorld run_;
  LiveInstruments instruments_;
  LiveFrame measured_;
  std::string title_;
  std::vector<Vec3> reach_;
  PlayHead head_;
  int number_ = 0;  // of frame_
  std::optional<Clock::time_point> updated_;
};

}  // namespace weft::engine::app
