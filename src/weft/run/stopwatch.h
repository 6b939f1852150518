#pragma once
/// Wall and processor time between start() and stop().

#include <chrono>
#include <ctime>

namespace weft::engine {

class Stopwatch {
 public:
  /// `cpu_total`: of earlier processes [s].
  explicit Stopwatch(double cpu_total = 0) : cpu_total_(cpu_total) {}

  void start() {
    wall_ = std::chrono::steady_clock::now();
    cpu_ = cpu_seconds();
  }

  /// Wall time since start() [s]; processor time of the whole process is added to cpu_total().
  double stop() {
    cpu_total_ += cpu_seconds() - cpu_;
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
  }

  double cpu_total() const { return cpu_total_; }  // [s]

 private:
  static double cpu_seconds() {
#ifdef CLOCK_PROCESS_CPUTIME_ID
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
#else
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
#endif
  }

  std::chrono::steady_clock::time_point wall_;
  double cpu_ = 0, cpu_total_;
};

}  // namespace weft::engine
