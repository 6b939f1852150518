#include "view_quality.h"

#include <algorithm>
#include <array>

namespace weft::engine::app {
namespace {

struct Level {
  RenderSettings settings;
  double scale;  // of the picture's sides [1]
};

const std::array kLevels = {
    Level{{.samples = 4, .shadow_size = 2048, .occlusion = true}, 1},
    Level{{.samples = 1, .shadow_size = 1024, .occlusion = true}, 1},
    Level{{.samples = 1, .shadow_size = 1024, .occlusion = false}, 1},
    Level{{.samples = 1, .shadow_size = 1024, .occlusion = false}, 0.7},
    Level{{.samples = 1, .shadow_size = 512, .occlusion = false}, 0.5},
    Level{{.samples = 1, .shadow_size = 512, .occlusion = false}, 0.35},
};

constexpr int kFirstInSoftware = 2;
constexpr double kTooSlow = 45, kFast = 12;  // [ms]
constexpr int kSettle = 4;                   // pictures before a level is evaluated [1]
constexpr int kTryAgain = 600;               // pictures before a better level is tried again [1]

int pixels(double scale, int side) { return std::max(1, static_cast<int>(scale * side)); }

}  // namespace

ViewQuality::ViewQuality(bool adapts) : adapts_(adapts), level_(adapts ? kFirstInSoftware : 0) {}

RenderSettings ViewQuality::settings(bool is_still) const { return kLevels[is_still ? 0 : level_].settings; }

PictureSize ViewQuality::scaled(PictureSize size, bool is_still) const {
  const double scale = kLevels[is_still ? 0 : level_].scale;
  return {pixels(scale, size.width), pixels(scale, size.height)};
}

void ViewQuality::add(double ms) {
  if (!adapts_) return;
  mean_ms_ = since_ == 0 ? ms : 0.75 * mean_ms_ + 0.25 * ms;
  if (++since_ < kSettle) return;
  if (since_ > kTryAgain) best_ = 0;
  const int last = static_cast<int>(kLevels.size()) - 1;
  if (mean_ms_ > kTooSlow && level_ < last) {
    level_ = std::min(last, level_ + (mean_ms_ > 2 * kTooSlow ? 2 : 1));
    best_ = level_;
    since_ = 0;
  } else if (mean_ms_ < kFast && level_ > best_) {
    --level_;
    since_ = 0;
  }
}

}  // namespace weft::engine::app
