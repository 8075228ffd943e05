// A place to draw without a screen. OSMesa is the first choice (software, needs nothing but its library);
// EGL's surfaceless platform is the second, because Mesa 25 dropped OSMesa. Both libraries are opened when
// the first picture is asked for: linking OSMesa would cost every process 20 ms and 50 MB at start.
#pragma once
#include <memory>
#include <string>

#include "engine/sinks/picture/gl/gl_api.h"

namespace truestep::picture {

/// An OpenGL 3.3 core context; its default framebuffer is not used.
class GlContext {
 public:
  virtual ~GlContext() = default;
  /// Makes it current in the calling thread; throws Error("render_unavailable") when the driver refuses.
  virtual void bind() = 0;
  /// Detaches it from the calling thread, so that another thread may bind it.
  virtual void release() = 0;
  /// "osmesa" or "egl".
  virtual std::string backend() const = 0;

  const GlApi& gl() const { return gl_; }

 protected:
  using Resolver = void (*(*)(const char*))();
  /// Fetches every function (the context must be current); throws Error("render_unavailable") naming the
  /// missing one.
  void load(Resolver resolve);

 private:
  GlApi gl_;
};

/// Keeps a context bound while alive.
class GlCurrent {
 public:
  explicit GlCurrent(GlContext& context) : context_(context) { context_.bind(); }
  ~GlCurrent() { context_.release(); }
  GlCurrent(const GlCurrent&) = delete;
  GlCurrent& operator=(const GlCurrent&) = delete;

 private:
  GlContext& context_;
};

/// Both throw Error("render_unavailable") saying what was missing.
std::unique_ptr<GlContext> create_osmesa_context();
std::unique_ptr<GlContext> create_egl_context();

/// OSMesa, otherwise EGL; throws Error("render_unavailable") with both reasons.
std::unique_ptr<GlContext> create_gl_context();

}  // namespace truestep::picture
