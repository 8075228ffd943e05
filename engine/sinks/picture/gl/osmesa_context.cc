// Off-screen Mesa: the context draws into our own memory. The library is opened, not linked, and never
// closed, since its compiler threads outlive the last context.
#include <dlfcn.h>

#include <array>

#include "engine/base/errors.h"
#include "engine/sinks/picture/gl/gl_context.h"
// After gl_context.h: it includes <GL/gl.h> itself, without prototypes.
#include <GL/osmesa.h>

namespace truestep::picture {
namespace {

struct OsMesa {
  decltype(&OSMesaCreateContextAttribs) create = nullptr;
  decltype(&OSMesaDestroyContext) destroy = nullptr;
  decltype(&OSMesaMakeCurrent) make_current = nullptr;
  decltype(&OSMesaGetProcAddress) resolve = nullptr;
};

OsMesa open_osmesa() {
  void* library = nullptr;
  for (const char* name : {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"})
    if ((library = dlopen(name, RTLD_NOW | RTLD_LOCAL))) break;
  if (!library) throw Error("render_unavailable", "libOSMesa is not installed (Debian package libosmesa6)");
  OsMesa m;
  m.create = reinterpret_cast<decltype(m.create)>(dlsym(library, "OSMesaCreateContextAttribs"));
  m.destroy = reinterpret_cast<decltype(m.destroy)>(dlsym(library, "OSMesaDestroyContext"));
  m.make_current = reinterpret_cast<decltype(m.make_current)>(dlsym(library, "OSMesaMakeCurrent"));
  m.resolve = reinterpret_cast<decltype(m.resolve)>(dlsym(library, "OSMesaGetProcAddress"));
  if (!m.create || !m.destroy || !m.make_current || !m.resolve)
    throw Error("render_unavailable", "this libOSMesa is too old to make a core profile");
  return m;
}

const OsMesa& osmesa() {
  static const OsMesa functions = open_osmesa();
  return functions;
}

class OsMesaContext final : public GlContext {
 public:
  OsMesaContext() {
    const int attributes[] = {OSMESA_FORMAT,
                              OSMESA_RGBA,
                              OSMESA_DEPTH_BITS,
                              0,
                              OSMESA_STENCIL_BITS,
                              0,
                              OSMESA_ACCUM_BITS,
                              0,
                              OSMESA_PROFILE,
                              OSMESA_CORE_PROFILE,
                              OSMESA_CONTEXT_MAJOR_VERSION,
                              3,
                              OSMESA_CONTEXT_MINOR_VERSION,
                              3,
                              0};
    context_ = osmesa().create(attributes, nullptr);
    if (!context_) throw Error("render_unavailable", "OSMesa has no OpenGL 3.3 core profile");
    try {
      bind();
      load(reinterpret_cast<Resolver>(osmesa().resolve));
      release();
    } catch (...) {
      osmesa().destroy(context_);
      throw;
    }
  }
  ~OsMesaContext() override { osmesa().destroy(context_); }

  void bind() override {
    if (!osmesa().make_current(context_, pixels_.data(), GL_UNSIGNED_BYTE, kSide, kSide))
      throw Error("render_unavailable", "OSMesa could not make its context current");
  }
  void release() override { osmesa().make_current(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }
  std::string backend() const override { return "osmesa"; }

 private:
  static constexpr int kSide = 8;  // the default framebuffer is never drawn to
  std::array<unsigned char, 4 * kSide * kSide> pixels_{};
  OSMesaContext context_ = nullptr;
};

}  // namespace

std::unique_ptr<GlContext> create_osmesa_context() {
  return std::make_unique<OsMesaContext>();
}

}  // namespace truestep::picture
