#pragma once
/// What the window, or one of its two halves, shows: a simulation, or the frames of a run.

#include <chrono>
#include <deque>

#include "weft/pictures/scene_picture.h"
#include "weft/render/pick.h"
#include "weft/run/live.h"
#include "weft/run/playback.h"

namespace weft::engine::app {

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

  virtual LiveSimulation* live() { return nullptr; }            // null: frames of a run
  virtual const LiveStatus* status() const { return nullptr; }  // of live()
  virtual const std::deque<LiveSample>& samples() const {       // of the last steps of live()
    static const std::deque<LiveSample> kNone;
    return kNone;
  }
  virtual PlayHead* head() { return nullptr; }  // null: a simulation
  virtual int num_frames() { return 0; }        // of a run, with the start
  virtual int frame() const { return 0; }       // of a run: the current one

  /// The current picture: cloth, or its springs; and the attachment, drawn towards `target`.
  Picture draw(const Camera& camera, bool springs, const std::optional<Vec3>& target) const;

  /// The first hit of a ray, if it is on a cloth.
  struct ClothHit {
    ClothPoint point;
    Vec3 place;  // [m]
  };
  std::optional<ClothHit> pick(const Ray& ray) const;

  Vec3 center() const;  // of the first cloth's particles [m]

 protected:
  ViewSide() = default;

  Animation meshes_;                                              // without frames
  AnimationFrame frame_;                                          // the current one
  std::vector<std::shared_ptr<const ClothTopology>> topologies_;  // (num_cloths) of live()
  double ground_ = 0;  // height of the ground in scenes without a floor [m]
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
  const std::deque<LiveSample>& samples() const override { return samples_; }

 private:
  LiveSimulation live_;
  LiveFrame newest_;
  std::shared_ptr<const Animation> start_;  // of meshes_
  std::deque<LiveSample> samples_;
};

/// The frames of a run, in their time.
class RunSide : public ViewSide {
 public:
  /// Throws InputError like open_frames().
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
  int num_frames() override { return frames_->num_frames(); }
  int frame() const override { return number_; }

 private:
  using Clock = std::chrono::steady_clock;

  std::unique_ptr<FrameSource> frames_;
  std::string title_;
  std::vector<Vec3> reach_;
  PlayHead head_;
  int number_ = 0;  // of frame_
  std::optional<Clock::time_point> updated_;
};

}  // namespace weft::engine::app
