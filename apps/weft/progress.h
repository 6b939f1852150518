#pragma once
/// A progress bar with the time left, and Ctrl-C.

#include <string>

#include "weft/run/runner.h"

namespace weft::app {

/// Draws one line on standard error while a run goes on: a bar on a terminal, nothing elsewhere.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label);

  void update(const Progress& progress);
  void clear();

 private:
  std::string label_;
  bool is_terminal_;
  double last_drawn_ = -1;  // seconds spent at the last drawing
};

/// From now on the first Ctrl-C only sets interrupted(); one that comes seconds later ends the program at
/// once.
void catch_interrupts();
bool interrupted();

/// "1 min 20 s", "0.8 s".
std::string format_seconds(double seconds);

}  // namespace weft::app
