// EGL on Mesa's surfaceless platform (EGL_MESA_platform_surfaceless, EGL_KHR_surfaceless_context). The few
// names below are from the EGL 1.5 registry; with them neither the library nor its headers are needed to
// build.
#include <dlfcn.h>

#include "engine/base/errors.h"
#include "engine/sinks/picture/gl/gl_context.h"

namespace truestep::picture {
namespace {

constexpr unsigned kOpenGlApi = 0x30A2, kPlatformSurfaceless = 0x31DD;
constexpr int kNone = 0x3038, kMajor = 0x3098, kMinor = 0x30FB, kProfileMask = 0x30FD, kCoreProfile = 1;

struct Egl {
  void (*(*resolve)(const char*))() = nullptr;
  void* (*get_platform_display)(unsigned, void*, const int*) = nullptr;
  unsigned (*initialize)(void*, int*, int*) = nullptr;
  unsigned (*bind_api)(unsigned) = nullptr;
  void* (*create_context)(void*, void*, void*, const int*) = nullptr;
  unsigned (*destroy_context)(void*, void*) = nullptr;
  unsigned (*make_current)(void*, void*, void*, void*) = nullptr;
  void* display = nullptr;  // one per process, never terminated: other contexts may still use it
};

template <class F>
void fetch(void* library, const char* name, F& function) {
  function = reinterpret_cast<F>(dlsym(library, name));
  if (!function) throw Error("render_unavailable", std::string("libEGL has no ") + name);
}

Egl open_egl() {
  void* library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
  if (!library) throw Error("render_unavailable", "libEGL is not installed (Debian package libegl1)");
  Egl e;
  fetch(library, "eglGetProcAddress", e.resolve);
  fetch(library, "eglGetPlatformDisplay", e.get_platform_display);
  fetch(library, "eglInitialize", e.initialize);
  fetch(library, "eglBindAPI", e.bind_api);
  fetch(library, "eglCreateContext", e.create_context);
  fetch(library, "eglDestroyContext", e.destroy_context);
  fetch(library, "eglMakeCurrent", e.make_current);
  e.display = e.get_platform_display(kPlatformSurfaceless, nullptr, nullptr);
  if (!e.display || !e.initialize(e.display, nullptr, nullptr))
    throw Error("render_unavailable", "EGL has no surfaceless display");
  return e;
}

const Egl& egl() {
  static const Egl functions = open_egl();
  return functions;
}

class EglContext final : public GlContext {
 public:
  EglContext() {
    const int attributes[] = {kMajor, 3, kMinor, 3, kProfileMask, kCoreProfile, kNone};
    const Egl& e = egl();
    select_api();
    context_ =
        e.create_context(e.display, nullptr, nullptr, attributes);  // no config: EGL_KHR_no_config_context
    if (!context_) throw Error("render_unavailable", "EGL has no OpenGL 3.3 core profile");
    try {
      bind();
      load(e.resolve);
      release();
    } catch (...) {
      e.destroy_context(e.display, context_);
      throw;
    }
  }
  ~EglContext() override { egl().destroy_context(egl().display, context_); }

  void bind() override {
    select_api();
    if (!egl().make_current(egl().display, nullptr, nullptr, context_))
      throw Error("render_unavailable", "EGL could not make its context current");
  }
  void release() override { egl().make_current(egl().display, nullptr, nullptr, nullptr); }
  std::string backend() const override { return "egl"; }

 private:
  // The client API is a property of the thread, and releasing only concerns the thread's current API.
  static void select_api() {
    if (!egl().bind_api(kOpenGlApi)) throw Error("render_unavailable", "EGL offers no desktop OpenGL");
  }

  void* context_ = nullptr;
};

}  // namespace

std::unique_ptr<GlContext> create_egl_context() {
  return std::make_unique<EglContext>();
}

}  // namespace truestep::picture
