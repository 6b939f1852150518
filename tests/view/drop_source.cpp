#include "tests/view/drop_source.h"

#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <array>
#include <chrono>
#include <thread>

namespace weft::engine {
namespace {

constexpr long kVersion = 5;
constexpr int kPatience = 30;  // [s]

class DropSource {
 public:
  explicit DropSource(const std::string& file)
      : display_(XOpenDisplay(nullptr)), text_("file://" + file + "\r\n") {
    if (!display_) return;
    window_ = XCreateSimpleWindow(display_, DefaultRootWindow(display_), -10, -10, 1, 1, 0, 0, 0);
    XSetSelectionOwner(display_, atom("XdndSelection"), window_, CurrentTime);
  }
  ~DropSource() {
    if (display_) XCloseDisplay(display_);
  }
  DropSource(const DropSource&) = delete;
  DropSource& operator=(const DropSource&) = delete;

  bool drop(int x, int y) {
    if (!display_ || !find_target()) return false;
    send("XdndEnter", {kVersion << 24, static_cast<long>(atom("text/uri-list")), 0, 0});
    send("XdndPosition",
         {0, static_cast<long>(x) << 16 | y, CurrentTime, static_cast<long>(atom("XdndActionCopy"))});
    if (!wait_for("XdndStatus")) return false;
    send("XdndDrop", {0, CurrentTime, 0, 0});
    return wait_for("XdndFinished");
  }

 private:
  Atom atom(const char* name) { return XInternAtom(display_, name, False); }

  /// Without a window manager, windows are children of the root.
  bool find_target() {
    Window root = 0, parent = 0, *children = nullptr;
    unsigned count = 0;
    if (!XQueryTree(display_, DefaultRootWindow(display_), &root, &parent, &children, &count)) return false;
    for (unsigned k = 0; k < count; ++k) {
      Atom type = 0;
      int format = 0;
      unsigned long items = 0, left = 0;
      unsigned char* data = nullptr;
      XGetWindowProperty(display_, children[k], atom("XdndAware"), 0, 1, False, AnyPropertyType, &type,
                         &format, &items, &left, &data);
      if (data) XFree(data);
      if (type != None) target_ = children[k];
    }
    if (children) XFree(children);
    return target_ != 0;
  }

  void send(const char* message, const std::array<long, 4>& values) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = target_;
    event.xclient.message_type = atom(message);
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(window_);
    for (int k = 0; k < 4; ++k) event.xclient.data.l[k + 1] = values[k];
    XSendEvent(display_, target_, False, NoEventMask, &event);
    XFlush(display_);
  }

  /// Gives the file's name to whoever asks meanwhile.
  bool wait_for(const char* message) {
    const auto start = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - start < std::chrono::seconds(kPatience)) {
      if (XPending(display_) == 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        continue;
      }
      XEvent event;
      XNextEvent(display_, &event);
      if (event.type == SelectionRequest) answer(event.xselectionrequest);
      if (event.type == ClientMessage && event.xclient.message_type == atom(message)) return true;
    }
    return false;
  }

  void answer(const XSelectionRequestEvent& request) {
    XChangeProperty(display_, request.requestor, request.property, request.target, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(text_.data()), static_cast<int>(text_.size()));
    XEvent event{};
    event.xselection.type = SelectionNotify;
    event.xselection.requestor = request.requestor;
    event.xselection.selection = request.selection;
    event.xselection.target = request.target;
    event.xselection.property = request.property;
    event.xselection.time = request.time;
    XSendEvent(display_, request.requestor, False, NoEventMask, &event);
    XFlush(display_);
  }

  Display* display_;
  std::string text_;
  Window window_ = 0, target_ = 0;
};

}  // namespace

bool drop_file(const std::string& file, int x, int y) { return DropSource(file).drop(x, y); }

}  // namespace weft::engine
