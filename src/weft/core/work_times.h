#pragma once
/// Where the time of a step goes, by kinds of work, and how much of each there was.

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <utility>

namespace weft {

/// Wall time on the thread that calls World::step(). The kinds do not overlap; what total has beyond their
/// sum is the rest: springs and elements, vectors, copies. `rows` to `v_cycle` are of `newton` alone.
struct WorkTimes {
  double total = 0;         // of whole steps [s]
  double lists = 0;         // finding what may meet (contact/proximity.h) [s]
  double narrow_phase = 0;  // distances of listed pairs and of plain shapes, as constraints [s]
  double rows = 0;          // contacts told to the solve, linearised, and their energy [s]
  double set_up = 0;        // preconditioners made anew for contacts [s]
  double product = 0;       // of contacts' Hessian with a vector, in conjugate gradients [s]
  double v_cycle = 0;       // preconditioners applied, with contact and without [s]
  double projection = 0;    // Gauss–Seidel over positions and velocities, after the solve and before [s]
  double ccd = 0;           // the last line without its lists (contact/last_line.h) [s]
  double retries = 0;       // parts of steps that were thrown away, all their work: no kind of its own [s]

  int pairs_listed = 0;          // in the longest list [1]
  std::size_t looks = 0;         // times that all listed pairs were tested [1]
  std::size_t pairs_tested = 0;  // in these [1]
  std::size_t active = 0;  // contacts that pushed in the solve, or else were set apart; of every part [1]
  std::size_t list_renewals = 0;  // searches for pairs, of all or of what had moved [1]

  double kinds() const { return lists + narrow_phase + rows + set_up + product + v_cycle + projection + ccd; }

  WorkTimes& operator+=(const WorkTimes& other) {
    for (const auto seconds : {&WorkTimes::total, &WorkTimes::lists, &WorkTimes::narrow_phase,
                               &WorkTimes::rows, &WorkTimes::set_up, &WorkTimes::product, &WorkTimes::v_cycle,
                               &WorkTimes::projection, &WorkTimes::ccd, &WorkTimes::retries})
      this->*seconds += other.*seconds;
    for (const auto count :
         {&WorkTimes::looks, &WorkTimes::pairs_tested, &WorkTimes::active, &WorkTimes::list_renewals})
      this->*count += other.*count;
    pairs_listed = std::max(pairs_listed, other.pairs_listed);
    return *this;
  }
};

/// Measures the WorkTimes of a step. One kind runs at a time, so that a block within a block counts once.
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

  /// From now on time is of this kind; null: of none. Returns the kind before.
  Kind turn_to(Kind kind) {
    const Clock::time_point now = Clock::now();
    if (kind_) times.*kind_ += since(turned_, now);
    turned_ = now;
    return std::exchange(kind_, kind);
  }

  /// Calls body(), whose time is of no kind and not in the total.
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

/// A block of one kind of work. Without a clock it does nothing.
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

}  // namespace weft
