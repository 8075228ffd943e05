// What can be rendered: a scene, simulated as far as the pictures need, or a recording.
#pragma once
#include <memory>
#include <optional>
#include <string>

#include "engine/sinks/picture/draw/draw_world.h"

namespace truestep {

class PictureSource {
 public:
  virtual ~PictureSource() = default;
  /// Times (s) of the first and the last possible picture.
  virtual double begin() const = 0;
  virtual double end() const = 0;
  /// The drawing at time t, or at the last frame before it.
  virtual DrawList at(double t) = 0;
  struct End {
    std::string why;
    double time;  ///< s, of the last picture there is
  };
  /// Why there are no pictures after some time: the scene became unstable.
  virtual std::optional<End> failure() const { return std::nullopt; }
};

/// A scene file, a gallery name, "-", or a recording. `threads` 0: all. Errors as for load_scene_document and
/// RecordingReader.
std::unique_ptr<PictureSource> open_source(const std::string& source, const PictureLook& look, int threads);

}  // namespace truestep
