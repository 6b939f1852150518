#pragma once
/// Stopwatches of a step by kind of work (WorkTimes, in weft/report.h).

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <utility>

#include "weft/report.h"

namespace weft::engine {

/// Measures the WorkTimes of a step. One kind runs at a time: time in a nested block counts only there.
class WorkClock {
 public:
  using Kind = double WorkTimes::*;

  void start() {
    times = {};
    kind_ = nullptr;
    began_ = Clock::now();
  }

  double seconds() const { return since(began_, Clock::now()); }  // since start() [s]

  const WorkTimes& stop() {
    times.total = seconds();
    return times;
  }

  /// Attributes time to this kind from now on; null: to none. Returns the previous kind.
  Kind turn_to(Kind kind) {
    const Clock::time_point now = Clock::now();
    if (kind_) times.*kind_ += since(turned_, now);
    turned_ = now;
    return std::exchange(kind_, kind);
  }

  /// Calls body(), excluding its time from all kinds and the total.
  template <class Body>
  void leave_out(const Body& body) {
    const Kind kind = turn_to(nullptr);
    const Clock::time_point then = Clock::now();
    body();
    began_ += Clock::now() - then;
    turn_to(kind);
  }

  void add_look(std::size_t pairs) {
    ++times.looks;
    times.pairs_tested += pairs;
    times.pairs_listed = std::max(times.pairs_listed, static_cast<int>(pairs));
  }

  WorkTimes times;

 private:
  using Clock = std::chrono::steady_clock;
  static double since(Clock::time_point then, Clock::time_point now) {
    return std::chrono::duration<double>(now - then).count();
  }

  Kind kind_ = nullptr;
  Clock::time_point began_, turned_;
};

/// Scope of one kind of work. A no-op without a clock.
class WorkScope {
 public:
  WorkScope(WorkClock* clock, WorkClock::Kind kind) : clock_(clock) {
    if (clock_) outer_ = clock_->turn_to(kind);
  }
  ~WorkScope() {
    if (clock_) clock_->turn_to(outer_);
  }
  WorkScope(const WorkScope&) = delete;
  WorkScope& operator=(const WorkScope&) = delete;

 private:
  WorkClock* clock_;
  WorkClock::Kind outer_ = nullptr;
};

}  // namespace weft::engine
