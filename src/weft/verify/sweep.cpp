#include "weft/verify/sweep.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

namespace weft::engine::verify {
namespace {

constexpr int kMaxStrips = 1024;
constexpr float kBoxesPerStrip = 3;  // width of a strip, in mean widths of boxes

}  // namespace

Sweep::Sweep(std::vector<Box> boxes) : boxes_(std::move(boxes)) {
  choose_axes();
  std::sort(boxes_.begin(), boxes_.end(), [this](const Box& p, const Box& q) {
    return std::pair(p.low[sweep_axis_], p.id) < std::pair(q.low[sweep_axis_], q.id);
  });
  fill_strips();
}

int Sweep::Strip::collect_overlaps(std::size_t i, int* hits) const {
  const int num_boxes = static_cast<int>(boxes.size());
  const float to = end[i], ly = low_y[i], hy = high_y[i], lz = low_z[i], hz = high_z[i];
  int count = 0;
  for (int j = static_cast<int>(i) + 1; j < num_boxes && start[j] <= to; ++j) {
    hits[count] = j;
    count += int{low_y[j] <= hy} & int{high_y[j] >= ly} & int{low_z[j] <= hz} & int{high_z[j] >= lz};
  }
  return count;
}

/// The sweep is along the axis of greatest variance of the boxes, the strips along the second.
void Sweep::choose_axes() {
  Vec3 sum = Vec3::Zero(), sum_sq = Vec3::Zero();
  for (const Box& box : boxes_) {
    const Vec3 low(box.low[0], box.low[1], box.low[2]);
    sum += low;
    sum_sq += low.cwiseAbs2();
  }
  const double count = std::max<double>(1, static_cast<double>(boxes_.size()));
  const Vec3 variance = sum_sq / count - (sum / count).cwiseAbs2();
  std::array<int, 3> axes = {0, 1, 2};
  std::sort(axes.begin(), axes.end(), [&](int i, int j) { return variance[i] > variance[j]; });
  std::tie(sweep_axis_, strip_axis_, third_axis_) = std::tie(axes[0], axes[1], axes[2]);
}

void Sweep::fill_strips() {
  float low = std::numeric_limits<float>::max(), high = -low;
  double widths = 0;
  for (const Box& box : boxes_) {
    low = std::min(low, box.low[strip_axis_]);
    high = std::max(high, box.high[strip_axis_]);
    widths += box.high[strip_axis_] - box.low[strip_axis_];
  }
  const double width = kBoxesPerStrip * widths / std::max<double>(1, static_cast<double>(boxes_.size()));
  const double wanted = width > 0 ? (static_cast<double>(high) - low) / width : 1;
  strips_.resize(static_cast<std::size_t>(std::clamp(wanted, 1.0, double{kMaxStrips})));
  const auto strip_at = [&](float x) {
    const double place = high > low ? (static_cast<double>(x) - low) / (static_cast<double>(high) - low) : 0;
    return std::min(static_cast<int>(place * static_cast<double>(strips_.size())),
                    static_cast<int>(strips_.size()) - 1);
  };
  for (int k = 0; k < static_cast<int>(boxes_.size()); ++k) {
    Box& box = boxes_[k];
    box.first_strip = strip_at(box.low[strip_axis_]);
    const int last = strip_at(box.high[strip_axis_]);
    for (int s = box.first_strip; s <= last; ++s) add_to_strip(k, strips_[s]);
  }
}

void Sweep::add_to_strip(int k, Strip& strip) const {
  const Box& box = boxes_[k];
  strip.boxes.push_back(k);
  strip.start.push_back(box.low[sweep_axis_]);
  strip.end.push_back(box.high[sweep_axis_]);
  strip.low_y.push_back(box.low[strip_axis_]);
  strip.high_y.push_back(box.high[strip_axis_]);
  strip.low_z.push_back(box.low[third_axis_]);
  strip.high_z.push_back(box.high[third_axis_]);
}

}  // namespace weft::engine::verify
