#pragma once
/// How well pictures are drawn while something moves: as well as there is time for.

#include "weft/render/renderer.h"

namespace weft::engine::app {

class ViewQuality {
 public:
  /// `adapts`: OpenGL in software. A graphics card always draws its best.
  explicit ViewQuality(bool adapts);

  RenderSettings settings(bool is_still) const;
  PictureSize scaled(PictureSize size, bool is_still) const;  // of the pictures, to be shown at `size`
  int level() const { return level_; }                        // 0 is best [1]

  /// A moving picture took so long to draw and to appear [ms].
  void add(double ms);

 private:
  bool adapts_;
  int level_ = 0;
  int best_ = 0;        // levels above this one have proved too slow
  int since_ = 0;       // pictures since the level changed [1]
  double mean_ms_ = 0;  // of the last few pictures [ms]
};

}  // namespace weft::engine::app
