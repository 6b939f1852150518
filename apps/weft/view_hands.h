#pragma once
/// The mouse on the picture: it turns the view, grabs cloth, moves, turns and throws bodies, pins particles,
/// probes, and draws the wind.

#include <chrono>
#include <deque>

#include "view_side.h"
#include "weft/scene/collider_edits.h"
#include "weft/window/window.h"

namespace weft::engine::app {

class Viewer;

inline constexpr double kStrongestWind = 15;  // that the window's controls set [m/s]

class Hands {
 public:
  explicit Hands(Viewer& viewer) : viewer_(viewer) {}

  void press(MouseButton button, double x, double y, Modifiers held);
  void move(double x, double y);
  void release(MouseButton button);

  void update();                                // the held or thrown body, before each picture
  void mark(int side, Picture& picture) const;  // what a hand holds, and where to
  void stop() { thrown_.reset(); }              // a body that flies, where it is
  void forget();                                // everything, for another scene

  /// Before the eye, beside the middle; a floor below everything. The new body is the touched one.
  void add_body(NewCollider kind);
  void remove_body();                                      // the touched one
  const std::string& touched() const { return touched_; }  // name of the body; "": none

  void toggle_wind() { shows_wind_ = !shows_wind_; }
  bool shows_wind() const { return shows_wind_; }
  Vec3 wind_foot() const;  // of the arrow [m]
  Vec3 wind_tip() const;   // likewise [m]

  bool is_grabbing() const { return drag_ == Drag::cloth; }
  bool is_throwing() const { return thrown_.has_value(); }
  int side() const;  // under the mouse

  /// The selection that is drawn; empty: none [pixels].
  std::optional<Eigen::AlignedBox2d> box() const;

 private:
  using Clock = std::chrono::steady_clock;
  enum class Drag { none, orbit, pan, cloth, body, turn, box, wind };

  /// A body that is moved by hand, or was.
  struct Body {
    std::size_t index = 0;  // of the scene's colliders
    ColliderSceneDesc from;
    Vec3 center = Vec3::Zero();                           // [m]
    double lowest = 0;                                    // height of its lowest point [m]
    Pose by;                                              // displacement so far
    bool is_moved = false;                                // since the last picture
    std::deque<std::pair<Clock::time_point, Vec3>> path;  // of `by`, for its speed [m]
  };
  struct Throw {
    Vec3 from, velocity;  // displacement and speed at its start [m], [m/s]
    double start;         // [s]
  };

  Drag choose(MouseButton button, Modifiers held);
  Drag touch(const ViewHit& hit, bool turns);
  void click(MouseButton button);
  Vec3 facing(double x, double y, const Vec3& through) const;
  void drag_wind(double x, double y);
  void turn_body(double dx, double dy);
  void put_body();
  void let_go_of_body();
  void fly();
  double floor_height() const;
  Eigen::AlignedBox2d selection() const;
  void pin_box();
  void pin(int cloth, const std::vector<int>& particles, bool removes);

  Viewer& viewer_;
  Drag drag_ = Drag::none;
  MouseButton button_ = MouseButton::left;
  Modifiers held_;
  double x_ = 0, y_ = 0;              // of the mouse
  double start_x_ = 0, start_y_ = 0;  // of the drag
  int side_ = 0;                      // likewise
  Vec3 place_ = Vec3::Zero();         // likewise, on cloth or body [m]
  std::optional<Vec3> target_;        // of a grab of cloth [m]
  std::optional<Body> body_;
  std::optional<Throw> thrown_;  // of body_
  std::string touched_;
  bool shows_wind_ = false;
};

}  // namespace weft::engine::app
