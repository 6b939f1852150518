#pragma once
/// Progress of a run, remaining time, and terminating signals.

#include <chrono>
#include <string>

#include "weft/run/scene_run.h"

namespace weft::engine::app {

/// Log lines: one every ten seconds, the first after ten.
class ProgressLog {
 public:
  static constexpr double kInterval = 10;  // [s]

  explicit ProgressLog(std::string label) : label_(std::move(label)) {}

  /// The due line after a frame, `elapsed` after the start [s]; empty if none is due. Reports the frame's
  /// time if that exceeds ten seconds.
  std::string line(const Progress& progress, double elapsed);

 private:
  std::string label_;
  double due_ = kInterval;  // time of the next line, after the start [s]
  double spent_ = 0;        // on simulation up to the previous frame [s]
};

/// Reports progress on standard error: a bar on a terminal, the lines of a ProgressLog elsewhere. A failed
/// write to standard error is ignored.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label);
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Reports a step of preparation, before the first frame.
  void prepare(const std::string& what);
  void update(const Progress& progress);
  void clear();

 private:
  void draw(const Progress& progress);
  void show(const std::string& text);

  std::string label_;
  bool is_terminal_;
  bool is_shown_ = false;
  double last_drawn_ = -1;  // simulation time at the last drawing [s]
  ProgressLog log_;
  double preparation_logged_ = 0;  // time of the latest line about preparation, after the start [s]
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// From now on the first Ctrl-C (SIGINT), SIGTERM or SIGHUP only sets interrupted(); one that comes seconds
/// later terminates the program at once. An ignored SIGHUP (nohup) stays ignored.
void catch_interrupts();
bool interrupted();

/// "1 min 20 s", "0.8 s".
std::string format_seconds(double seconds);

}  // namespace weft::engine::app
