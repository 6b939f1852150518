#include "weft/run/live_history.h"

#include <algorithm>

namespace weft::engine {

bool LiveHistory::wants(std::int64_t steps) const {
  return moments_.empty() || (steps % kSpacing == 0 && moments_.back().steps < steps);
}

void LiveHistory::add(LiveMoment moment, std::size_t num_particles) {
  moments_.push_back(std::move(moment));
  const double bytes = kBytesPerParticle * static_cast<double>(std::max<std::size_t>(num_particles, 1));
  const auto is_too_much = [&] {
    return moments_.size() > 1 && (moments_[1].time <= moments_.back().time - kSpan ||
                                   static_cast<double>(moments_.size()) * bytes > kMaxBytes);
  };
  while (is_too_much()) moments_.pop_front();
  while (!changes_.empty() && changes_.front().steps < first()) changes_.pop_front();
}

void LiveHistory::add_change(std::int64_t steps, std::function<void()> change) {
  changes_.push_back({steps, std::move(change)});
}

void LiveHistory::forget_after(std::int64_t steps) {
  while (!moments_.empty() && moments_.back().steps > steps) moments_.pop_back();
  while (!changes_.empty() && changes_.back().steps >= steps) changes_.pop_back();
}

void LiveHistory::clear() {
  moments_.clear();
  changes_.clear();
}

const LiveMoment& LiveHistory::moment_before(std::int64_t steps) const {
  const auto after =
      std::upper_bound(moments_.begin(), moments_.end(), steps,
                       [](std::int64_t wanted, const LiveMoment& m) { return wanted < m.steps; });
  return after == moments_.begin() ? moments_.front() : *(after - 1);
}

void LiveHistory::repeat_changes(std::int64_t steps) const {
  for (const Change& change : changes_) {
    if (change.steps == steps) change.make();
  }
}

}  // namespace weft::engine
