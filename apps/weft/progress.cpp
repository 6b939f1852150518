#include "progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <ctime>

namespace weft::app {
namespace {

constexpr int kBarWidth = 28;
constexpr double kRedrawInterval = 0.1;  // [s]

// `timeout` and job managers send one interrupt twice: to the program and to its group.
constexpr std::time_t kSameInterrupt = 2;  // [s]

volatile std::sig_atomic_t g_interrupted = 0;
std::time_t g_interrupted_at = 0;

// The first interrupt asks the run to end and keep what is done; a later one ends the program at once.
void on_interrupt(int) {
  const std::time_t now = std::time(nullptr);
  if (g_interrupted == 0) {
    g_interrupted_at = now;
    g_interrupted = 1;
  } else if (now - g_interrupted_at >= kSameInterrupt) {
    std::signal(SIGINT, SIG_DFL);
    std::raise(SIGINT);
  }
}

}  // namespace

ProgressBar::ProgressBar(std::string label)
    : label_(std::move(label)), is_terminal_(isatty(STDERR_FILENO) != 0) {}

void ProgressBar::update(const Progress& p) {
  if (!is_terminal_) return;
  if (p.frame < p.num_frames && p.seconds_spent - last_drawn_ < kRedrawInterval) return;
  last_drawn_ = p.seconds_spent;
  const int filled = kBarWidth * p.frame / std::max(1, p.num_frames);
  fmt::print(stderr, "\r\033[K{:<26} [{}{}] {:>3}/{} frames, {} left", label_, std::string(filled, '='),
             std::string(kBarWidth - filled, ' '), p.frame, p.num_frames, format_seconds(p.seconds_left));
  std::fflush(stderr);
}

void ProgressBar::clear() {
  if (is_terminal_) fmt::print(stderr, "\r\033[K");
}

void catch_interrupts() { std::signal(SIGINT, on_interrupt); }

bool interrupted() { return g_interrupted != 0; }

std::string format_seconds(double seconds) {
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  const int whole = static_cast<int>(std::lround(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  return fmt::format("{} min {} s", whole / 60, whole % 60);
}

}  // namespace weft::app
