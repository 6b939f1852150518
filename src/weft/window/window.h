#pragma once
/// A window that shows pictures, with controls over them. All calls must be on the thread that created it.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "weft/render/device.h"

namespace weft::engine {

/// Non-letter keys; letters and digits are their own codes, as in 'R'. Help is F1, panels F6, report F12.
enum SpecialKey {
  kKeyEscape = 256,
  kKeyRight,
  kKeyLeft,
  kKeyDelete,
  kKeyHelp,
  kKeyPanels,
  kKeyReport
};

enum class MouseButton { left, right, middle };

/// Keys that are held down.
struct Modifiers {
  bool shift = false, control = false;
};

/// User input as callbacks. Positions are in pixels from the window's upper left corner. Input to the
/// controls is not reported, except function keys, and Escape while the keyboard moves among controls.
struct WindowEvents {
  std::function<void(int key, Modifiers held)> on_key;
  std::function<void(MouseButton button, double x, double y, Modifiers held)> on_press;
  std::function<void(MouseButton button)> on_release;
  std::function<void(double x, double y)> on_move;
  std::function<void(double clicks)> on_wheel;                         // > 0: away from the user
  std::function<void(const std::vector<std::string>& files)> on_drop;  // from another program
};

struct WindowSettings {
  std::string title = "Weft";
  PictureSize size;

  /// Processors for software OpenGL besides the calling thread, with Mesa; the environment variable
  /// LP_NUM_THREADS takes precedence.
  int software_threads = 1;
};

/// A window with an OpenGL context, current on this thread. Each frame:
///
///     begin_frame(events)   input since the last frame
///     …                     draw with a Renderer on make_device(), call Dear ImGui for controls
///     end_frame()           draws the controls on top and presents the frame
class Window {
 public:
  /// Throws GraphicsError without a display or without OpenGL 3.3.
  explicit Window(const WindowSettings& settings);
  ~Window();

  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// A device that draws to this window; destroy it first.
  std::unique_ptr<Device> make_device();

  PictureSize size() const;           // of the visible area [pixels]
  double scale() const;               // of controls, for the same appearance on any screen [1]
  bool is_software() const;           // OpenGL runs on the processor
  const std::string& driver() const;  // its name

  bool is_typing() const;  // a text field has the keyboard

  /// The keyboard moves among the controls: arrows, space to press, Enter to edit, ctrl+Tab for other panels.
  void navigate(bool enabled);
  bool is_navigating() const;

  bool is_closing() const;  // the user has requested to close it
  void close();
  void keep_open();  // refuses the request
  void set_title(const std::string& title);

  /// A picture for Dear ImGui, kept until the window closes.
  std::uint64_t make_texture(const Image& image);

  /// Sleeps until the next input, or for this long. False: there was none [s].
  bool wait_for_event(double seconds);

  void begin_frame(const WindowEvents& events);
  void end_frame();

  /// As end_frame; returns the window's contents.
  Image end_frame_and_read();

 private:
  struct System;
  std::unique_ptr<System> system_;
};

}  // namespace weft::engine
