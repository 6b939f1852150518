#include "tests/view/input_delay.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>

namespace weft::engine {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kSide = 160;     // of the watched square [pixels]
constexpr int kStep = 40;      // of the pointer [pixels]
constexpr int kPatience = 10;  // [s]
constexpr int kRest = 1000;    // before each move, longer than all pictures of the move before [ms]

std::string read_middle(Display* display, int x, int y) {
  XImage* image = XGetImage(display, DefaultRootWindow(display), x, y, kSide, kSide, AllPlanes, ZPixmap);
  if (!image) return "";
  std::string bytes(image->data, static_cast<std::size_t>(image->bytes_per_line) * kSide);
  XDestroyImage(image);
  return bytes;
}

}  // namespace

std::vector<double> measure_input_delays(int times, int x, int y) {
  const std::unique_ptr<Display, int (*)(Display*)> display(XOpenDisplay(nullptr), XCloseDisplay);
  std::vector<double> delays;
  for (int k = 0; display && k < times; ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(kRest));
    const std::string before = read_middle(display.get(), x - kSide, y - kSide);
    const Clock::time_point start = Clock::now();
    XWarpPointer(display.get(), None, DefaultRootWindow(display.get()), 0, 0, 0, 0,
                 x + (k % 2 == 0 ? kStep : 0), y);
    XSync(display.get(), False);
    while (read_middle(display.get(), x - kSide, y - kSide) == before) {
      if (Clock::now() - start > std::chrono::seconds(kPatience)) return delays;
      std::this_thread::sleep_for(std::chrono::microseconds(500));
    }
    delays.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  }
  return delays;
}

}  // namespace weft::engine
