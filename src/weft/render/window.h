#pragma once
/// A window that shows pictures, with controls over them. Everything here belongs to the thread that made it.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "weft/render/device.h"

namespace weft::engine {

/// Keys that are no letters; letters and digits are themselves, as in 'R'.
enum SpecialKey { kKeyEscape = 256, kKeyRight, kKeyLeft, kKeyHelp };  // kKeyHelp: F1

enum class MouseButton { left, right, middle };

/// What people do, as calls. Places are pixels from the window's upper left corner. What they do to the
/// controls is not told.
struct WindowEvents {
  std::function<void(int key, bool shift)> on_key;
  std::function<void(MouseButton button, double x, double y, bool shift)> on_press;
  std::function<void(MouseButton button)> on_release;
  std::function<void(double x, double y)> on_move;
  std::function<void(double clicks)> on_wheel;  // > 0: away from the hand
};

struct WindowSettings {
  std::string title = "Weft";
  PictureSize size;

  /// Processors that OpenGL in software may use besides the calling thread, where it is Mesa's; the
  /// environment's LP_NUM_THREADS comes first.
  int software_threads = 1;
};

/// A window with an OpenGL context, current on this thread. Each frame:
///
///     begin_frame(events)   what people have done since the last one
///     …                     draw with a Renderer on make_device(), call Dear ImGui for controls
///     end_frame()           controls on top; then all of it appears
class Window {
 public:
  /// Throws GraphicsError where there is no display or no OpenGL 3.3.
  explicit Window(const WindowSettings& settings);
  ~Window();

  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Draws to this window; to be destroyed before it.
  std::unique_ptr<Device> make_device();

  PictureSize size() const;           // of what is seen, now [pixels]
  double scale() const;               // of controls, so that they look alike on any screen [1]
  bool is_software() const;           // OpenGL is computed by the processor
  const std::string& driver() const;  // its name

  bool is_closing() const;  // somebody wants it closed
  void close();

  /// Sleeps until somebody does something, or for so long [s].
  void wait_for_event(double seconds);

  void begin_frame(const WindowEvents& events);
  void end_frame();

  /// As end_frame, and returns what the window shows.
  Image end_frame_and_read();

 private:
  struct System;
  std::unique_ptr<System> system_;
};

}  // namespace weft::engine
