#include "engine/sinks/picture/gl/gl_context.h"

#include "engine/base/errors.h"

namespace truestep::picture {

void GlContext::load(Resolver resolve) {
#define TRUESTEP_GL_LOAD(name)                                          \
  gl_.name = reinterpret_cast<decltype(gl_.name)>(resolve("gl" #name)); \
  if (!gl_.name) throw Error("render_unavailable", "the OpenGL driver has no gl" #name);
  TRUESTEP_GL_FUNCTIONS(TRUESTEP_GL_LOAD)
#undef TRUESTEP_GL_LOAD
}

std::unique_ptr<GlContext> create_gl_context() {
  try {
    return create_osmesa_context();
  } catch (const Error& osmesa) {
    try {
      return create_egl_context();
    } catch (const Error& egl) {
      throw Error("render_unavailable",
                  std::string("pictures need OSMesa or EGL: ") + osmesa.what() + "; " + egl.what());
    }
  }
}

}  // namespace truestep::picture
