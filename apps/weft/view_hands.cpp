#include "view_hands.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "viewer.h"
#include "weft/scene/scene_changes.h"

namespace weft::engine::app {
namespace {

constexpr double kOrbitDegrees = 0.35;  // per pixel of a drag
constexpr double kTurnDegrees = 0.5;    // likewise, of a body
constexpr double kClick = 4;            // longest way of a click [pixels]
constexpr double kTip = 16;             // of the wind's arrow: what the mouse takes hold of [pixels]
constexpr double kWindLength = 0.02;    // of the arrow, per m/s, as a share of the camera's distance
constexpr double kMemory = 0.1;         // over which the speed of a throw is measured [s]
constexpr double kSlowest = 0.3;        // of throws [m/s]
constexpr double kFlight = 3;           // longest, without a floor [s]
constexpr double kNewSize = 0.06, kNewAside = 0.25;  // of new bodies, as shares of the camera's distance [1]
constexpr Color kHand = {0.95, 0.35, 0.02};

double seconds(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

}  // namespace

int Hands::side() const { return viewer_.side_at(x_); }

// ---- Presses, moves, releases ---------------------------------------------------------------------------

void Hands::press(MouseButton button, double x, double y, Modifiers held) {
  if (drag_ != Drag::none) return;
  x_ = start_x_ = x;
  y_ = start_y_ = y;
  button_ = button;
  held_ = held;
  side_ = side();
  drag_ = choose(button, held);
}

Hands::Drag Hands::choose(MouseButton button, Modifiers held) {
  if (button == MouseButton::middle || (held.shift && !held.control)) return Drag::pan;
  if (button == MouseButton::right || !viewer_.is_simulation()) return Drag::orbit;
  const WindowPart part = viewer_.part(side_);
  if (shows_wind_ && !held.control) {
    const auto tip = viewer_.camera().pixel(wind_tip(), part.size);
    if (tip && (*tip + Eigen::Vector2d(part.x, 0) - Eigen::Vector2d(x_, y_)).norm() <
                   kTip * viewer_.window().scale())
      return Drag::wind;
  }
  const std::optional<ViewHit> hit = viewer_.side(side_).pick(viewer_.ray_at(side_, x_, y_));
  const Drag touched = hit ? touch(*hit, held.control) : Drag::none;
  if (touched != Drag::none) return touched;
  return held.control ? Drag::box : Drag::orbit;
}

/// Takes hold of what the mouse is on; none: it is not to be moved.
Hands::Drag Hands::touch(const ViewHit& hit, bool turns) {
  place_ = hit.place;
  if (hit.cloth) {
    if (turns) return Drag::none;
    for (int s = 0; s < viewer_.num_sides(); ++s) viewer_.side(s).live()->grab(*hit.cloth);
    target_ = place_;
    return Drag::cloth;
  }
  const auto index = static_cast<std::size_t>(hit.body);
  const std::vector<ColliderSceneDesc>& colliders = viewer_.edits()->now().colliders;
  if (index >= colliders.size()) return Drag::none;
  touched_ = colliders[index].name;
  if (!is_movable(colliders[index])) return Drag::none;
  const Eigen::AlignedBox3d box = viewer_.side(side_).box_of_body(hit.body);
  thrown_.reset();
  viewer_.settle_edits();
  body_ = Body{.index = index, .from = colliders[index], .center = box.center(), .lowest = box.min().y()};
  return turns ? Drag::turn : Drag::body;
}

void Hands::move(double x, double y) {
  const double dx = x - x_, dy = y - y_;
  x_ = x;
  y_ = y;
  Camera& camera = viewer_.camera();
  switch (drag_) {
    case Drag::none:
    case Drag::box:
      return;
    case Drag::orbit:
      return camera.orbit(-kOrbitDegrees * dx, kOrbitDegrees * dy);
    case Drag::pan: {
      const double height = viewer_.part(0).size.height;
      return camera.pan(-dx / height, dy / height);
    }
    case Drag::cloth:
      target_ = facing(x, y, place_);
      for (int s = 0; s < viewer_.num_sides(); ++s) viewer_.side(s).live()->move_grab(*target_);
      return;
    case Drag::body:
      body_->by.translation = facing(x, y, place_) - place_;
      body_->is_moved = true;
      body_->path.emplace_back(Clock::now(), body_->by.translation);
      return;
    case Drag::turn:
      return turn_body(dx, dy);
    case Drag::wind:
      return drag_wind(x, y);
  }
}

void Hands::release(MouseButton button) {
  if (button != button_ || drag_ == Drag::none) return;
  const bool is_click = std::hypot(x_ - start_x_, y_ - start_y_) < kClick;
  const Drag ended = std::exchange(drag_, Drag::none);
  if (ended == Drag::cloth) {
    for (int s = 0; s < viewer_.num_sides(); ++s) viewer_.side(s).live()->release();
    target_.reset();
  }
  if (ended == Drag::body || ended == Drag::turn) let_go_of_body();
  if (ended == Drag::wind) viewer_.settle_edits();
  if (ended == Drag::box && !is_click) pin_box();
  if (is_click) click(button);
}

/// With the right button a probe; with the left one and control a pin.
void Hands::click(MouseButton button) {
  if (viewer_.shows_gallery()) return;
  const std::optional<ViewHit> hit = viewer_.side(side_).pick(viewer_.ray_at(side_, x_, y_));
  const std::optional<ClothPoint> point = hit ? hit->cloth : std::nullopt;
  if (button == MouseButton::right) return viewer_.set_probe(point);
  if (button != MouseButton::left || !held_.control || !point || !viewer_.is_simulation()) return;
  const ViewSide& side = viewer_.side(side_);
  const int particle = side.meshes().cloths[point->cloth].triangles[point->triangle][point->nearest_corner()];
  const std::vector<int>& pinned = (*side.measured()->pins)[point->cloth].particles;
  pin(point->cloth, {particle}, held_.shift || std::ranges::find(pinned, particle) != pinned.end());
}

void Hands::forget() {
  drag_ = Drag::none;
  target_.reset();
  body_.reset();
  thrown_.reset();
  touched_.clear();
}

/// The point below the mouse in the plane through another one that faces the camera.
Vec3 Hands::facing(double x, double y, const Vec3& through) const {
  const Ray ray = viewer_.ray_at(side_, x, y);
  const Vec3 forward = viewer_.camera().forward();
  return ray.origin + (through - ray.origin).dot(forward) / ray.direction.dot(forward) * ray.direction;
}

void Hands::mark(int side, Picture& picture) const {
  const LiveStatus* status = viewer_.side(side).status();
  if (status && status->held) {
    picture.dots.push_back({.positions = {*status->held}, .color = kHand, .diameter = 11});
    if (target_) picture.lines.push_back({.ends = {*status->held, *target_}, .color = kHand, .width = 2.5});
  }
  if (drag_ != Drag::body) return;
  const Vec3 wanted = place_ + body_->by.translation;
  picture.dots.push_back({.positions = {wanted}, .color = kHand, .diameter = 11});
  if (static_cast<int>(body_->index) >= static_cast<int>(viewer_.side(side).meshes().bodies.size())) return;
  const Vec3 center = viewer_.side(side).box_of_body(static_cast<int>(body_->index)).center();
  picture.lines.push_back(
      {.ends = {center + (place_ - body_->center), wanted}, .color = kHand, .width = 2.5});
}

// ---- Bodies ---------------------------------------------------------------------------------------------

void Hands::turn_body(double dx, double dy) {
  const Camera& camera = viewer_.camera();
  const double radians = kTurnDegrees * std::numbers::pi / 180;
  const Mat3 turn =
      (Eigen::AngleAxisd(radians * dx, camera.up()) * Eigen::AngleAxisd(radians * dy, camera.right()))
          .toRotationMatrix();
  body_->by.rotation = turn * body_->by.rotation;
  body_->by.translation = body_->center - body_->by.rotation * body_->center;
  body_->is_moved = true;
}

void Hands::update() {
  if (thrown_) fly();
  if (body_ && body_->is_moved) put_body();
}

/// Into the scene, which the simulation takes.
void Hands::put_body() {
  body_->is_moved = false;
  SceneDesc next = viewer_.edits()->now();
  if (body_->index >= next.colliders.size() || next.colliders[body_->index].name != body_->from.name)
    return forget();
  next.colliders[body_->index] = body_->from;
  displace(body_->by, next.colliders[body_->index]);
  viewer_.edit(std::move(next), "body");
}

/// A body that is let go while it moves flies on.
void Hands::let_go_of_body() {
  if (body_->is_moved) put_body();
  if (!body_) return;
  std::deque<std::pair<Clock::time_point, Vec3>>& path = body_->path;
  const Clock::time_point now = Clock::now();
  if (!path.empty() && seconds(now - path.back().first) > kMemory) path.clear();  // it rested
  while (path.size() > 2 && seconds(now - path[1].first) > kMemory) path.pop_front();
  if (path.size() > 1 && viewer_.is_playing()) {
    const double time = std::max(seconds(path.back().first - path.front().first), 1e-3);
    const Vec3 velocity = (path.back().second - path.front().second) / time;
    if (velocity.norm() > kSlowest) {
      thrown_ = Throw{body_->by.translation, std::min(1.0, kMaxGlideSpeed / velocity.norm()) * velocity,
                      viewer_.side(side_).status()->time};
      return;
    }
  }
  viewer_.settle_edits();
}

/// Free flight until the floor.
void Hands::fly() {
  const double time = viewer_.side(side_).status()->time - thrown_->start;
  const double floor = floor_height() - body_->lowest;
  Vec3 by = thrown_->from + time * thrown_->velocity + time * time / 2 * viewer_.edits()->now().gravity;
  const bool has_landed = by.y() <= floor && thrown_->from.y() > floor;
  if (has_landed) by.y() = floor;
  if (time > 0) {
    body_->by.translation = by;
    body_->is_moved = true;
  }
  if (!has_landed && time >= 0 && time < kFlight) return;
  thrown_.reset();
  put_body();
  viewer_.settle_edits();
}

/// Of the highest level plane below the body, or of the ground.
double Hands::floor_height() const {
  double height = viewer_.side(side_).ground();
  for (const ColliderSceneDesc& collider : viewer_.edits()->now().colliders) {
    const Plane* plane = std::get_if<Plane>(&collider.shape);
    if (plane && plane->normal.normalized().y() > 0.99 && plane->point.y() <= body_->lowest)
      height = std::max(height, plane->point.y());
  }
  return height;
}

void Hands::add_body(NewCollider kind) {
  SceneDesc next = viewer_.edits()->now();
  const Camera& camera = viewer_.camera();
  Vec3 place = camera.target + kNewAside * camera.distance * camera.right();
  if (kind == NewCollider::floor) place = Vec3(0, viewer_.side(0).ground(), 0);
  const std::size_t added = weft::engine::add_collider(kind, place, kNewSize * camera.distance, next);
  touched_ = next.colliders[added].name;
  viewer_.edit(std::move(next), "new body");
  viewer_.settle_edits();
}

void Hands::remove_body() {
  const std::vector<ColliderSceneDesc>& colliders = viewer_.edits()->now().colliders;
  const auto touched = std::ranges::find(colliders, touched_, &ColliderSceneDesc::name);
  if (touched_.empty() || touched == colliders.end()) return viewer_.say("click on the body to remove first");
  for (const ClothSceneDesc& cloth : viewer_.edits()->now().cloths) {
    if (std::ranges::find(cloth.pins, touched_, &PinDesc::follow) == cloth.pins.end()) continue;
    return viewer_.say("pins of cloth \"" + cloth.name + "\" follow " + touched_ + ": unpin them first");
  }
  SceneDesc next = viewer_.edits()->now();
  remove_collider(static_cast<std::size_t>(touched - colliders.begin()), next);
  forget();
  viewer_.edit(std::move(next), "no body");
  viewer_.settle_edits();
}

// ---- Pins -----------------------------------------------------------------------------------------------

/// Between the start of the drag and the mouse.
Eigen::AlignedBox2d Hands::selection() const {
  Eigen::AlignedBox2d box(Eigen::Vector2d(start_x_, start_y_));
  return box.extend(Eigen::Vector2d(x_, y_));
}

std::optional<Eigen::AlignedBox2d> Hands::box() const {
  if (drag_ != Drag::box) return std::nullopt;
  return selection();
}

/// All particles in the box, in front and behind.
void Hands::pin_box() {
  const WindowPart part = viewer_.part(side_);
  const Eigen::AlignedBox2d box = selection().translated(Eigen::Vector2d(-part.x, 0));
  const ViewSide& side = viewer_.side(side_);
  for (std::size_t c = 0; c < side.meshes().cloths.size(); ++c) {
    std::vector<int> inside;
    const int count = static_cast<int>(side.current_frame().cloths[c].size() / 3);
    for (int v = 0; v < count; ++v) {
      const auto pixel = viewer_.camera().pixel(side.position(static_cast<int>(c), v), part.size);
      if (pixel && box.contains(*pixel)) inside.push_back(v);
    }
    if (!inside.empty()) pin(static_cast<int>(c), inside, held_.shift);
  }
}

void Hands::pin(int cloth, const std::vector<int>& particles, bool removes) {
  const LivePins& pins = (*viewer_.side(side_).measured()->pins)[cloth];
  SceneDesc next = viewer_.edits()->now();
  ClothSceneDesc& pinned = next.cloths[cloth];
  if (pins.vertices.size() != pinned.pins.size())
    return viewer_.say("the pins that are shown are not the newest: go on for a step first");
  std::vector<int> vertices;
  for (const int particle : particles) {
    const auto at = static_cast<std::size_t>(particle);
    const int vertex = at < pins.vertex_of_particle.size() ? pins.vertex_of_particle[at] : -1;
    if (vertex >= 0) vertices.push_back(vertex);
  }
  if (vertices.empty()) return viewer_.say("this side of a tear has no vertex to pin: choose the other one");
  removes ? unpin_vertices(vertices, pins.vertices, pinned) : pin_vertices(vertices, pins.vertices, pinned);
  viewer_.edit(std::move(next), "pins");
  viewer_.settle_edits();
  viewer_.look.pins = true;
}

// ---- Wind -----------------------------------------------------------------------------------------------

Vec3 Hands::wind_foot() const { return viewer_.camera().target; }

Vec3 Hands::wind_tip() const {
  return wind_foot() + kWindLength * viewer_.camera().distance * viewer_.side(0).status()->wind.velocity;
}

void Hands::drag_wind(double x, double y) {
  const Vec3 wind = (facing(x, y, wind_tip()) - wind_foot()) / (kWindLength * viewer_.camera().distance);
  viewer_.set_wind(std::min(1.0, kStrongestWind / std::max(wind.norm(), 1e-9)) * wind);
}

}  // namespace weft::engine::app
