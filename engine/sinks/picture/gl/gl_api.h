// The OpenGL functions that pictures use, fetched by name from whichever library made the context: nothing
// links against libGL, whose symbols would hide those of OSMesa. The prototypes are used only for their
// types.
#pragma once
#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>

namespace truestep::picture {

// clang-format off
#define TRUESTEP_GL_FUNCTIONS(X) \
  X(GetString) X(GetIntegerv) X(GetError) X(Enable) \
  X(Disable) X(DepthMask) X(DepthFunc) X(BlendFunc) \
  X(PolygonOffset) X(Viewport) X(Clear) X(ColorMask) \
  X(DrawArrays) X(DrawElements) X(DrawBuffer) X(ReadBuffer) \
  X(ReadPixels) X(PixelStorei) X(GenTextures) X(DeleteTextures) \
  X(BindTexture) X(TexImage2D) X(TexParameteri) X(ActiveTexture) X(GenSamplers) X(BindSampler) X(SamplerParameteri) \
  X(CreateShader) X(ShaderSource) X(CompileShader) X(GetShaderiv) \
  X(GetShaderInfoLog) X(DeleteShader) X(CreateProgram) X(AttachShader) \
  X(LinkProgram) X(GetProgramiv) X(GetProgramInfoLog) X(DeleteProgram) \
  X(UseProgram) X(GetUniformLocation) X(Uniform1i) X(GetUniformBlockIndex) \
  X(UniformBlockBinding) X(GenBuffers) X(DeleteBuffers) X(BindBuffer) \
  X(BindBufferBase) X(BufferData) X(GenVertexArrays) X(DeleteVertexArrays) \
  X(BindVertexArray) X(EnableVertexAttribArray) X(VertexAttribPointer) X(GenFramebuffers) \
  X(DeleteFramebuffers) X(BindFramebuffer) X(FramebufferTexture2D) X(FramebufferRenderbuffer) \
  X(CheckFramebufferStatus) X(BlitFramebuffer) X(GenRenderbuffers) X(DeleteRenderbuffers) \
  X(BindRenderbuffer) X(RenderbufferStorageMultisample)
// clang-format on

/// One pointer per function, without the gl prefix: gl.Clear(...).
struct GlApi {
#define TRUESTEP_GL_MEMBER(name) decltype(&gl##name) name = nullptr;  // NOLINT(bugprone-macro-parentheses)
  TRUESTEP_GL_FUNCTIONS(TRUESTEP_GL_MEMBER)
#undef TRUESTEP_GL_MEMBER
};

}  // namespace truestep::picture
