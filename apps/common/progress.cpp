#include "apps/common/progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <ctime>

namespace weft::engine::app {
namespace {

constexpr int kBarWidth = 28;
constexpr double kRedrawInterval = 0.1;  // [s]

// `timeout` and job managers send one signal twice: to the program and to its process group.
constexpr std::time_t kSameInterrupt = 2;  // [s]

volatile std::sig_atomic_t g_interrupted = 0;
std::time_t g_interrupted_at = 0;

// The first signal requests the run to end and keep its results; a later one terminates the program at once.
void on_interrupt(int signal) {
  const std::time_t now = std::time(nullptr);
  if (g_interrupted == 0) {
    g_interrupted_at = now;
    g_interrupted = 1;
  } else if (now - g_interrupted_at >= kSameInterrupt) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

bool is_ignored(int signal) {
  struct sigaction now {};
  return sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

}  // namespace

std::string ProgressLog::line(const Progress& p, double elapsed) {
  const double frame_seconds = p.seconds_spent - spent_;
  spent_ = p.seconds_spent;
  if (elapsed < due_ || p.frame >= p.num_frames) return "";
  due_ = kInterval * (std::floor(elapsed / kInterval) + 1);
  std::string line = fmt::format("{}: frame {} of {}, {} left", label_, p.frame, p.num_frames,
                                 format_seconds(p.seconds_left));
  if (frame_seconds > kInterval)
    line += fmt::format("; the last frame took {}", format_seconds(frame_seconds));
  return line;
}

ProgressBar::ProgressBar(std::string label)
    : label_(std::move(label)), is_terminal_(isatty(STDERR_FILENO) != 0), log_(label_) {}

void ProgressBar::prepare(const std::string& what) {
  if (is_terminal_) return show(label_ + ": " + what);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  if (elapsed.count() < preparation_logged_ + ProgressLog::kInterval) return;
  preparation_logged_ = elapsed.count();
  std::fputs((label_ + ": " + what + "\n").c_str(), stderr);
}

void ProgressBar::update(const Progress& p) {
  if (is_terminal_) return draw(p);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  const std::string line = log_.line(p, elapsed.count());
  if (!line.empty()) std::fputs((line + "\n").c_str(), stderr);
}

void ProgressBar::draw(const Progress& p) {
  if (p.frame < p.num_frames && p.seconds_spent - last_drawn_ < kRedrawInterval) return;
  last_drawn_ = p.seconds_spent;
  const int filled = kBarWidth * p.frame / std::max(1, p.num_frames);
  show(fmt::format("{:<26} [{}{}] {:>3}/{} frames, {} left", label_, std::string(filled, '='),
                   std::string(kBarWidth - filled, ' '), p.frame, p.num_frames,
                   format_seconds(p.seconds_left)));
}

void ProgressBar::show(const std::string& text) {
  is_shown_ = true;
  std::fputs(("\r\033[K" + text).c_str(), stderr);
  std::fflush(stderr);
}

void ProgressBar::clear() {
  if (is_shown_) std::fputs("\r\033[K", stderr);
  is_shown_ = false;
}

void catch_interrupts() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (signal != SIGHUP || !is_ignored(signal)) std::signal(signal, on_interrupt);
  }
}

bool interrupted() { return g_interrupted != 0; }

std::string format_seconds(double seconds) {
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  const int whole = static_cast<int>(std::lround(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  return fmt::format("{} min {} s", whole / 60, whole % 60);
}

}  // namespace weft::engine::app
