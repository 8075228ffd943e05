// Pictures without a screen: a DrawList in, pixels out. Spheres are ray-cast with exact depth, lines are
// tubes of at least 1.5 pixels, surfaces are lit from both sides; one shadow map, 4-fold anti-aliasing, an
// endless-looking ground grid, a caption and a colour bar. The same list gives the same bytes on the same
// machine.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/sinks/picture/draw/draw_list.h"
#include "engine/sinks/picture/png.h"

namespace truestep {

/// Holds an off-screen OpenGL context. Creating one and drawing its first picture costs about 0.5 s (shaders
/// are compiled), so callers keep one per worker.
/// Any thread may use it, one at a time.
class PictureRenderer {
 public:
  static constexpr int kMinSide = 16, kMaxSide = 4096;  ///< pixels

  enum class Backend : uint8_t { any, osmesa, egl };  ///< any: OSMesa, else EGL

  /// Throws Error("out_of_range") for a size outside the limits, Error("render_unavailable") without OpenGL.
  PictureRenderer(int width, int height, Backend backend = Backend::any);
  ~PictureRenderer();
  PictureRenderer(PictureRenderer&&) noexcept;
  PictureRenderer& operator=(PictureRenderer&&) noexcept;

  /// Changes the size of later pictures and keeps the context; same errors as the constructor.
  void resize(int width, int height);

  /// height x width x 4 bytes, top row first, sRGB, opaque.
  /// Throws Error("invalid_draw_list") when indices or lengths do not fit, Error("render_unavailable") when
  /// the driver fails.
  std::vector<uint8_t> render_rgba(const DrawList& list);

  /// "osmesa" or "egl".
  std::string backend() const;
  int width() const;
  int height() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace truestep
