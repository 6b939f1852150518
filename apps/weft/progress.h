#pragma once
/// How far a run is, with the time left, and signals that end it.

#include <chrono>
#include <string>

#include "weft/run/scene_run.h"

namespace weft::engine::app {

/// Lines of text for a log: one each ten seconds, the first after ten.
class ProgressLog {
 public:
  explicit ProgressLog(std::string label) : label_(std::move(label)) {}

  /// The line that is due after a frame, `elapsed` after the start [s]; empty if none is. Tells how long the
  /// frame took if that was more than ten seconds.
  std::string line(const Progress& progress, double elapsed);

 private:
  std::string label_;
  double due_ = kInterval;  // the next line, after the start [s]
  double spent_ = 0;        // on simulation up to the frame before [s]

  static constexpr double kInterval = 10;  // [s]
};

/// Tells on standard error where a run is: a bar on a terminal, the lines of a ProgressLog elsewhere. A
/// standard error that cannot be written is no reason to fail.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label);

  void update(const Progress& progress);
  void clear();

 private:
  void draw(const Progress& progress);

  std::string label_;
  bool is_terminal_;
  double last_drawn_ = -1;  // seconds spent at the last drawing
  ProgressLog log_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// From now on the first of Ctrl-C (SIGINT), SIGTERM and SIGHUP only sets interrupted(); one that comes
/// seconds later ends the program at once. A SIGHUP that is ignored (nohup) stays so.
void catch_interrupts();
bool interrupted();

/// "1 min 20 s", "0.8 s".
std::string format_seconds(double seconds);

}  // namespace weft::engine::app
