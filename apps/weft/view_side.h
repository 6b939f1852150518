#pragma once
/// One simulation in the window: the only one, or one of two.

#include "weft/pictures/scene_picture.h"
#include "weft/render/pick.h"
#include "weft/run/live.h"

namespace weft::engine::app {

class ViewSide {
 public:
  ViewSide(const SceneDesc& scene, int threads);

  LiveSimulation& live() { return live_; }
  const LiveStatus& status() const { return frame_.status; }

  /// Fetches the newest frame; false if there is none since the last call.
  bool update();

  /// The current picture: cloth, or its springs; and the attachment, drawn towards `target`.
  Picture draw(const Camera& camera, bool springs, const std::optional<Vec3>& target) const;

  /// The first hit of a ray, if it is on a cloth.
  struct ClothHit {
    ClothPoint point;
    Vec3 place;  // [m]
  };
  std::optional<ClothHit> pick(const Ray& ray) const;

  Vec3 center() const;  // of the first cloth's particles [m]

 private:
  LiveSimulation live_;
  LiveFrame frame_;
  Animation animation_;  // one frame: the current one
  double ground_;        // height of the ground in scenes without a floor [m]
};

}  // namespace weft::engine::app
