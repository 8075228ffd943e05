// Programs, vertex buffers and framebuffers of one context. Nothing here is deleted one by one unless it is
// replaced: destroying the context frees all of it.
#pragma once
#include <span>

#include "engine/sinks/picture/gl/gl_api.h"
#include "engine/sinks/picture/gl/shaders.h"

namespace truestep::picture {

/// Compiles and links; binds block `Scene` to point 0, `shadow_map` and `shadow_depth` to texture units 0
/// and 1. Throws Error("render_unavailable") with the driver's log.
GLuint make_program(const GlApi& gl, const ShaderPair& source);

/// One float or byte attribute of a vertex struct.
struct Attribute {
  int components;
  GLenum type;  ///< GL_FLOAT, or GL_UNSIGNED_BYTE normalised to [0, 1]
  size_t offset;
};

/// A vertex array with its buffer, refilled for every picture, and optionally its own indices.
class VertexStream {
 public:
  /// `shared_indices` = 0 gives it an index buffer of its own.
  VertexStream(const GlApi& gl, size_t stride, std::span<const Attribute> attributes, GLuint shared_indices);
  void upload(const GlApi& gl, const void* vertices, size_t bytes, std::span<const uint32_t> indices);
  void bind(const GlApi& gl) const { gl.BindVertexArray(array_); }

 private:
  GLuint array_ = 0, buffer_ = 0, indices_ = 0;
};

/// The shadow map: one depth texture, sampled with comparison and filtering (unit 0) and as plain numbers
/// (unit 1).
class ShadowTarget {
 public:
  explicit ShadowTarget(const GlApi& gl);
  /// Makes it the framebuffer, `side` x `side` texels.
  void bind(const GlApi& gl, int side);
  void sample(const GlApi& gl) const;

 private:
  GLuint framebuffer_ = 0, texture_ = 0, samplers_[2] = {0, 0};
  int side_ = 0;
};

/// 4-fold multisampled sRGB colour and depth, and the plain buffer that it is resolved into.
class ColorTarget {
 public:
  /// Replaces the previous buffers; throws Error("render_unavailable") when the driver refuses the format.
  void allocate(const GlApi& gl, int width, int height);
  void bind(const GlApi& gl) const { gl.BindFramebuffer(GL_FRAMEBUFFER, samples_); }
  /// Averages the samples in linear light and copies the upper-left width x height pixels to `rgba`.
  void read(const GlApi& gl, int width, int height, int row_pixels, uint8_t* rgba) const;
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  GLuint samples_ = 0, resolved_ = 0, buffers_[3] = {0, 0, 0};
  int width_ = 0, height_ = 0;
};

}  // namespace truestep::picture
