#include <dlfcn.h>
#include <epoxy/egl.h>

#include "weft/render/device.h"

namespace weft::engine {
namespace {

constexpr const char* kAdvice =
    "; pictures require EGL and OpenGL 3.3 (on Debian and Ubuntu: apt-get install libegl1 libgl1 "
    "libgl1-mesa-dri)";

/// epoxy ends the process if it cannot load a library.
void require_libraries() {
  const auto loads = [](const char* library) { return dlopen(library, RTLD_LAZY | RTLD_LOCAL) != nullptr; };
  if (!loads("libEGL.so.1") || !(loads("libOpenGL.so.0") || loads("libGL.so.1")))
    throw GraphicsError(std::string("the libraries of EGL and OpenGL are not installed") + kAdvice);
}

/// An EGL display and context without a surface.
class EglContext {
 public:
  EglContext() {
    require_libraries();
    display_ = find_display();
    if (display_ == EGL_NO_DISPLAY || !eglInitialize(display_, nullptr, nullptr))
      throw GraphicsError(std::string("there is no EGL display") + kAdvice);
    try {
      make_context();
    } catch (const GraphicsError&) {
      eglTerminate(display_);
      throw;
    }
  }

  ~EglContext() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglTerminate(display_);
  }

  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  void make_current() const { eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_); }

 private:
  /// Mesa's surfaceless platform, which needs no display server; else EGL's default.
  static EGLDisplay find_display() {
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
      const EGLDisplay display =
          eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
      if (display != EGL_NO_DISPLAY) return display;
    }
    return eglGetDisplay(EGL_DEFAULT_DISPLAY);
  }

  void make_context() {
    if (!eglBindAPI(EGL_OPENGL_API))
      throw GraphicsError(std::string("EGL does not support OpenGL") + kAdvice);
    const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!eglChooseConfig(display_, wanted, &config, 1, &count) || count == 0)
      throw GraphicsError(std::string("EGL has no matching configuration") + kAdvice);
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION,
                              3,
                              EGL_CONTEXT_MINOR_VERSION,
                              3,
                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                              EGL_NONE};
    context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, version);
    if (context_ == EGL_NO_CONTEXT)
      throw GraphicsError(std::string("EGL cannot create an OpenGL 3.3 context") + kAdvice);
    if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
      throw GraphicsError(std::string("EGL does not support surfaceless contexts") + kAdvice);
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

/// The OpenGL device with its context.
class OffscreenDevice : public Device {
 public:
  TargetId target(std::string_view name, const TargetDesc& desc) override { return gl().target(name, desc); }
  GeometryId upload(std::span<const float> vertices, std::span<const Triangle> triangles) override {
    return gl().upload(vertices, triangles);
  }
  void forget_geometry() override { gl().forget_geometry(); }
  void begin_pass(TargetId target) override { gl().begin_pass(target); }
  void draw(const DrawCall& call) override { gl().draw(call); }
  void resolve(TargetId from, TargetId to) override { gl().resolve(from, to); }
  Image read(TargetId target) override { return gl().read(target); }
  void show(TargetId, const WindowPart&) override {}  // no window

 private:
  /// Makes its context current: several devices may share a thread.
  Device& gl() {
    context_.make_current();
    return *device_;
  }

  EglContext context_;
  std::unique_ptr<Device> device_ = make_gl_device();
};

}  // namespace

std::unique_ptr<Device> make_offscreen_device() { return std::make_unique<OffscreenDevice>(); }

}  // namespace weft::engine
