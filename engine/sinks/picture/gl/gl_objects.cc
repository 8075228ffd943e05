#include "engine/sinks/picture/gl/gl_objects.h"

#include <algorithm>
#include <array>
#include <string>

#include "engine/base/errors.h"

namespace truestep::picture {
namespace {

GLuint compile(const GlApi& gl, GLenum stage, const std::string& source) {
  const GLuint shader = gl.CreateShader(stage);
  const char* text = source.c_str();
  gl.ShaderSource(shader, 1, &text, nullptr);
  gl.CompileShader(shader);
  GLint done = 0;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &done);
  if (done) return shader;
  std::array<char, 1024> log{};
  gl.GetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw Error("render_unavailable", std::string("shader: ") + log.data());
}

void require_complete(const GlApi& gl) {
  const GLenum status = gl.CheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw Error("render_unavailable", "framebuffer status " + std::to_string(status));
}

}  // namespace

GLuint make_program(const GlApi& gl, const ShaderPair& source) {
  const GLuint program = gl.CreateProgram();
  const GLuint stages[] = {compile(gl, GL_VERTEX_SHADER, source.vertex),
                           compile(gl, GL_FRAGMENT_SHADER, source.fragment)};
  for (GLuint stage : stages) gl.AttachShader(program, stage);
  gl.LinkProgram(program);
  for (GLuint stage : stages) gl.DeleteShader(stage);  // once the program goes
  GLint done = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &done);
  if (!done) {
    std::array<char, 1024> log{};
    gl.GetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw Error("render_unavailable", std::string("shader program: ") + log.data());
  }
  const GLuint block = gl.GetUniformBlockIndex(program, "Scene");
  if (block != GL_INVALID_INDEX) gl.UniformBlockBinding(program, block, 0);
  gl.UseProgram(program);
  const std::pair<const char*, GLint> samplers[] = {{"shadow_map", 0}, {"shadow_depth", 1}};
  for (const auto& [name, unit] : samplers)
    if (const GLint place = gl.GetUniformLocation(program, name); place >= 0) gl.Uniform1i(place, unit);
  return program;
}

VertexStream::VertexStream(const GlApi& gl, size_t stride, std::span<const Attribute> attributes,
                           GLuint shared_indices) {
  gl.GenVertexArrays(1, &array_);
  gl.BindVertexArray(array_);
  gl.GenBuffers(1, &buffer_);
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer_);
  for (GLuint i = 0; i < attributes.size(); ++i) {
    const Attribute& a = attributes[i];
    gl.EnableVertexAttribArray(i);
    gl.VertexAttribPointer(i, a.components, a.type, a.type == GL_FLOAT ? GL_FALSE : GL_TRUE,
                           static_cast<GLsizei>(stride), reinterpret_cast<const void*>(a.offset));
  }
  if (!shared_indices) gl.GenBuffers(1, &indices_);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, shared_indices ? shared_indices : indices_);
}

void VertexStream::upload(const GlApi& gl, const void* vertices, size_t bytes,
                          std::span<const uint32_t> indices) {
  gl.BindVertexArray(array_);
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer_);
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes), vertices, GL_STREAM_DRAW);
  if (indices_)
    gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size_bytes()), indices.data(),
                  GL_STREAM_DRAW);
}

ShadowTarget::ShadowTarget(const GlApi& gl) {
  gl.GenTextures(1, &texture_);
  gl.GenSamplers(2, samplers_);
  for (int unit : {0, 1}) {
    const GLint filter = unit == 0 ? GL_LINEAR : GL_NEAREST;
    gl.SamplerParameteri(samplers_[unit], GL_TEXTURE_MIN_FILTER, filter);
    gl.SamplerParameteri(samplers_[unit], GL_TEXTURE_MAG_FILTER, filter);
    gl.SamplerParameteri(samplers_[unit], GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.SamplerParameteri(samplers_[unit], GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
  gl.SamplerParameteri(samplers_[0], GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  gl.SamplerParameteri(samplers_[0], GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  gl.GenFramebuffers(1, &framebuffer_);
}

void ShadowTarget::bind(const GlApi& gl, int side) {
  if (side != side_) {
    gl.BindTexture(GL_TEXTURE_2D, texture_);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, side, side, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT,
                  nullptr);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_, 0);
    gl.DrawBuffer(GL_NONE);
    gl.ReadBuffer(GL_NONE);
    require_complete(gl);
    side_ = side;
  }
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl.Viewport(0, 0, side, side);
}

void ShadowTarget::sample(const GlApi& gl) const {
  for (GLuint unit : {0u, 1u}) {
    gl.ActiveTexture(GL_TEXTURE0 + unit);
    gl.BindTexture(GL_TEXTURE_2D, texture_);
    gl.BindSampler(unit, samplers_[unit]);
  }
  gl.ActiveTexture(GL_TEXTURE0);
}

void ColorTarget::allocate(const GlApi& gl, int width, int height) {
  if (width == width_ && height == height_) return;
  gl.DeleteRenderbuffers(3, buffers_);  // zeros are ignored
  gl.DeleteFramebuffers(1, &samples_);
  gl.DeleteFramebuffers(1, &resolved_);
  gl.GenRenderbuffers(3, buffers_);
  gl.GenFramebuffers(1, &samples_);
  gl.GenFramebuffers(1, &resolved_);
  const GLenum formats[3] = {GL_SRGB8_ALPHA8, GL_DEPTH_COMPONENT24, GL_SRGB8_ALPHA8};
  for (int i = 0; i < 3; ++i) {
    gl.BindRenderbuffer(GL_RENDERBUFFER, buffers_[i]);
    gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, i < 2 ? 4 : 0, formats[i], width, height);
  }
  gl.BindFramebuffer(GL_FRAMEBUFFER, samples_);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers_[0]);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffers_[1]);
  require_complete(gl);
  gl.BindFramebuffer(GL_FRAMEBUFFER, resolved_);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers_[2]);
  require_complete(gl);
  width_ = width;
  height_ = height;
}

void ColorTarget::read(const GlApi& gl, int width, int height, int row_pixels, uint8_t* rgba) const {
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, samples_);
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
  gl.BlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, resolved_);
  gl.PixelStorei(GL_PACK_ROW_LENGTH, row_pixels);
  gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
}

}  // namespace truestep::picture
