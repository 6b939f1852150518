#include "weft/window/window.h"

// epoxy must precede GLFW, which otherwise includes OpenGL's own header.
#include <epoxy/gl.h>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cfloat>
#include <cstdlib>
#include <optional>
#include <variant>

namespace weft::engine {
namespace {

constexpr const char* kAdvice = "; weft render draws pictures and videos without a window";

struct KeyDown {
  int key;
  Modifiers held;

  bool is_function() const { return key == kKeyHelp || key == kKeyPanels || key == kKeyReport; }
};
struct Press {
  MouseButton button;
  double x, y;
  Modifiers held;
};
struct Release {
  MouseButton button;
};
struct Move {
  double x, y;
};
struct Wheel {
  double clicks;
};
struct Drop {
  std::vector<std::string> files;
};
using Event = std::variant<KeyDown, Press, Release, Move, Wheel, Drop>;

/// GLFW's letters and digits are ASCII; 0: an unused key.
int to_key(int glfw_key) {
  switch (glfw_key) {
    case GLFW_KEY_ESCAPE:
      return kKeyEscape;
    case GLFW_KEY_RIGHT:
      return kKeyRight;
    case GLFW_KEY_LEFT:
      return kKeyLeft;
    case GLFW_KEY_F1:
      return kKeyHelp;
    case GLFW_KEY_F6:
      return kKeyPanels;
    case GLFW_KEY_F12:
      return kKeyReport;
    case GLFW_KEY_DELETE:
      return kKeyDelete;
    default:
      return glfw_key >= GLFW_KEY_SPACE && glfw_key <= GLFW_KEY_Z ? glfw_key : 0;
  }
}

Modifiers to_modifiers(int mods) {
  return {.shift = (mods & GLFW_MOD_SHIFT) != 0, .control = (mods & GLFW_MOD_CONTROL) != 0};
}

std::string last_glfw_error() {
  const char* words = nullptr;
  glfwGetError(&words);
  return words ? words : "no reason given";
}

bool is_software_driver(const std::string& name) {
  for (const char* known : {"llvmpipe", "softpipe", "swrast", "SwiftShader", "Software"}) {
    if (name.find(known) != std::string::npos) return true;
  }
  return false;
}

}  // namespace

/// State of GLFW and Dear ImGui.
struct Window::System {
  GLFWwindow* window = nullptr;
  std::string driver;
  std::vector<Event> events;
  std::vector<std::pair<int, Modifiers>> taps;  // GLFW keys pressed since the last frame
  std::optional<ImVec2> pointer;                // where the last event has it; the system's may be ahead

  explicit System(const WindowSettings& settings) {
#ifndef _WIN32
    setenv("LP_NUM_THREADS", std::to_string(settings.software_threads).c_str(), 0);
#endif
    if (!glfwInit()) throw GraphicsError("there is no display for a window" + std::string(kAdvice));
    open(settings);
    glfwMakeContextCurrent(window);
    driver = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    glfwSwapInterval(1);
    listen();
    make_controls();
  }

  ~System() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(window);
    glfwTerminate();
  }

  void open(const WindowSettings& settings) {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0);  // pictures are drawn offscreen and copied
    window =
        glfwCreateWindow(settings.size.width, settings.size.height, settings.title.c_str(), nullptr, nullptr);
    if (window) return;
    const std::string reason = last_glfw_error();
    glfwTerminate();
    throw GraphicsError("cannot open a window with OpenGL 3.3 (" + reason + ")" + kAdvice);
  }

  /// Callbacks only record events: the controls process them first and may consume them.
  void listen() {
    glfwSetWindowUserPointer(window, this);
    glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int mods) {
      if (action == GLFW_RELEASE) return;
      if (to_key(key) != 0) of(w).push_back(KeyDown{to_key(key), to_modifiers(mods)});
      static_cast<System*>(glfwGetWindowUserPointer(w))->taps.push_back({key, to_modifiers(mods)});
    });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int mods) {
      if (button > GLFW_MOUSE_BUTTON_MIDDLE) return;
      const MouseButton which = button == GLFW_MOUSE_BUTTON_LEFT    ? MouseButton::left
                                : button == GLFW_MOUSE_BUTTON_RIGHT ? MouseButton::right
                                                                    : MouseButton::middle;
      if (action == GLFW_RELEASE) {
        of(w).push_back(Release{which});
        return;
      }
      double x = 0, y = 0;
      glfwGetCursorPos(w, &x, &y);
      const System& own = *static_cast<System*>(glfwGetWindowUserPointer(w));
      if (own.pointer) x = own.pointer->x, y = own.pointer->y;
      of(w).push_back(Press{which, x, y, to_modifiers(mods)});
    });
    glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
      of(w).push_back(Move{x, y});
      static_cast<System*>(glfwGetWindowUserPointer(w))->pointer =
          ImVec2(static_cast<float>(x), static_cast<float>(y));
    });
    glfwSetScrollCallback(window, [](GLFWwindow* w, double, double y) { of(w).push_back(Wheel{y}); });
    glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** files) {
      of(w).push_back(Drop{{files, files + count}});
    });
  }

  static std::vector<Event>& of(GLFWwindow* w) {
    return static_cast<System*>(glfwGetWindowUserPointer(w))->events;
  }

  void make_controls() {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // no settings file
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
  }

  /// Dear ImGui before 1.87 does not see a key that was pressed and released between two frames: here it is down
  /// for a frame. It asks the system where the pointer is, which is ahead of the buttons' events: a control would
  /// follow the pointer after its release. Later versions do better themselves.
  void show_events() {
#if IMGUI_VERSION_NUM < 18700
    ImGuiIO& io = ImGui::GetIO();
    if (pointer && io.MousePos.x > -FLT_MAX) io.MousePos = *pointer;
    for (const auto& [key, held] : taps) {
      if (key < 0) continue;
      io.KeysDown[key] = true;
      io.KeyShift |= held.shift;
      io.KeyCtrl |= held.control;
    }
#endif
  }

  void end_taps() {
#if IMGUI_VERSION_NUM < 18700
    ImGuiIO& io = ImGui::GetIO();
    for (const auto& [key, held] : taps) {
      if (key >= 0) io.KeysDown[key] = glfwGetKey(window, key) == GLFW_PRESS;
    }
    io.KeyShift = io.KeysDown[GLFW_KEY_LEFT_SHIFT] || io.KeysDown[GLFW_KEY_RIGHT_SHIFT];
    io.KeyCtrl = io.KeysDown[GLFW_KEY_LEFT_CONTROL] || io.KeysDown[GLFW_KEY_RIGHT_CONTROL];
#endif
    taps.clear();
  }

  /// Pixels per unit of GLFW's positions.
  double pixels() const {
    int width = 1, height = 1, wide = 1, high = 1;
    glfwGetWindowSize(window, &width, &height);
    glfwGetFramebufferSize(window, &wide, &high);
    return static_cast<double>(wide) / std::max(width, 1);
  }

  static bool is_navigating() {
    return (ImGui::GetIO().ConfigFlags & ImGuiConfigFlags_NavEnableKeyboard) != 0;
  }

  void dispatch(const Event& event, const WindowEvents& to) const {
    const ImGuiIO& io = ImGui::GetIO();
    if (const KeyDown* key = std::get_if<KeyDown>(&event)) {
      const bool is_free = !io.WantTextInput && (!is_navigating() || key->key == kKeyEscape);
      if (is_free || key->is_function()) to.on_key(key->key, key->held);
    } else if (const Press* press = std::get_if<Press>(&event)) {
      if (!io.WantCaptureMouse)
        to.on_press(press->button, pixels() * press->x, pixels() * press->y, press->held);
    } else if (const Release* release = std::get_if<Release>(&event)) {
      to.on_release(release->button);
    } else if (const Move* move = std::get_if<Move>(&event)) {
      to.on_move(pixels() * move->x, pixels() * move->y);
    } else if (const Drop* drop = std::get_if<Drop>(&event)) {
      to.on_drop(drop->files);
    } else if (!io.WantCaptureMouse) {
      to.on_wheel(std::get<Wheel>(event).clicks);
    }
  }

  void draw_controls() {
    ImGui::Render();
    end_taps();
    int width = 0, height = 0;
    glfwGetFramebufferSize(window, &width, &height);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, width, height);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  }

  Image read() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window, &width, &height);
    Image image(width, height);
    std::vector<std::uint8_t> rows(image.rgba.size());
    glReadBuffer(GL_BACK);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rows.data());
    const std::size_t row = 4 * static_cast<std::size_t>(width);
    for (int y = 0; y < height; ++y)
      std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(row * (height - 1 - y)), row, image.pixel(0, y));
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
    return image;
  }
};

Window::Window(const WindowSettings& settings) : system_(std::make_unique<System>(settings)) {}
Window::~Window() = default;

std::unique_ptr<Device> Window::make_device() { return make_gl_device(); }

PictureSize Window::size() const {
  PictureSize size;
  glfwGetFramebufferSize(system_->window, &size.width, &size.height);
  return {std::max(size.width, 1), std::max(size.height, 1)};
}

double Window::scale() const {
  float x = 1, y = 1;
  glfwGetWindowContentScale(system_->window, &x, &y);
  return std::max(1.0f, x);
}

bool Window::is_software() const { return is_software_driver(system_->driver); }
const std::string& Window::driver() const { return system_->driver; }
bool Window::is_typing() const { return ImGui::GetIO().WantTextInput; }
bool Window::is_navigating() const { return System::is_navigating(); }

void Window::navigate(bool enabled) {
  ImGuiConfigFlags& flags = ImGui::GetIO().ConfigFlags;
  flags = enabled ? flags | ImGuiConfigFlags_NavEnableKeyboard : flags & ~ImGuiConfigFlags_NavEnableKeyboard;
}

bool Window::is_closing() const { return glfwWindowShouldClose(system_->window); }
void Window::close() { glfwSetWindowShouldClose(system_->window, GLFW_TRUE); }

void Window::keep_open() { glfwSetWindowShouldClose(system_->window, GLFW_FALSE); }
void Window::set_title(const std::string& title) { glfwSetWindowTitle(system_->window, title.c_str()); }

std::uint64_t Window::make_texture(const Image& image) {
  unsigned int texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, image.width, image.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
               image.rgba.data());
  return texture;
}

bool Window::wait_for_event(double seconds) {
  const double start = glfwGetTime();
  glfwWaitEventsTimeout(seconds);
  return !system_->events.empty() || glfwGetTime() - start < seconds;  // on a busy machine input may come late
}

void Window::begin_frame(const WindowEvents& events) {
  glfwPollEvents();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  system_->show_events();
  ImGui::NewFrame();
  std::vector<Event> happened;
  happened.swap(system_->events);
  for (const Event& event : happened) system_->dispatch(event, events);
}

void Window::end_frame() {
  system_->draw_controls();
  glfwSwapBuffers(system_->window);
}

Image Window::end_frame_and_read() {
  system_->draw_controls();
  Image image = system_->read();
  glfwSwapBuffers(system_->window);
  return image;
}

}  // namespace weft::engine
