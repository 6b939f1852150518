#pragma once
/// One simulation in the window: it alone, or one of two side by side.

#include "weft/lab/scene_picture.h"
#include "weft/render/pick.h"
#include "weft/run/live.h"

namespace weft::engine::app {

class ViewSide {
 public:
  ViewSide(const SceneDesc& scene, int threads);

  LiveSimulation& live() { return live_; }
  const LiveStatus& status() const { return frame_.status; }

  /// Takes over the newest frame; false if there is none since the last call.
  bool update();

  /// What is seen now: cloth, or its springs; and the hand that holds it, drawn towards `target`.
  Picture draw(const Camera& camera, bool springs, const std::optional<Vec3>& target) const;

  /// The point of a cloth that a ray meets before anything else.
  struct ClothHit {
    ClothPoint point;
    Vec3 place;  // [m]
  };
  std::optional<ClothHit> pick(const Ray& ray) const;

  Vec3 center() const;  // of the first cloth's particles [m]

 private:
  LiveSimulation live_;
  LiveFrame frame_;
  Animation animation_;  // one frame: now
  double ground_;        // its height where the scene has no floor [m]
};

}  // namespace weft::engine::app
