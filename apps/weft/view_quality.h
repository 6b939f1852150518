#pragma once
/// Adaptive picture quality while the scene moves: the best that the frame time allows.

#include "weft/render/renderer.h"

namespace weft::engine::app {

class ViewQuality {
 public:
  /// `adapts`: software OpenGL. A graphics card always uses the best quality.
  explicit ViewQuality(bool adapts);

  RenderSettings settings(bool is_still) const;
  PictureSize scaled(PictureSize size, bool is_still) const;  // of the pictures, to be shown at `size`
  int level() const { return level_; }                        // 0 is best [1]

  /// Records the time to draw and show a moving picture [ms].
  void add(double ms);

 private:
  bool adapts_;
  int level_ = 0;
  int best_ = 0;        // lower levels have proved too slow
  int since_ = 0;       // pictures since the level changed [1]
  double mean_ms_ = 0;  // of the last few pictures [ms]
};

}  // namespace weft::engine::app
