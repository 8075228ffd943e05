// What can be rendered: a scene, which is simulated as far as it is looked at, or a recording.
#pragma once
#include <memory>
#include <optional>
#include <string>

#include "engine/sinks/picture/draw_world.h"

namespace truestep {

class PictureSource {
 public:
  virtual ~PictureSource() = default;
  /// Times (s) of the first and the last picture that there can be.
  virtual double begin() const = 0;
  virtual double end() const = 0;
  /// What is to be seen at time t, or shortly before.
  virtual DrawList at(double t) = 0;
  /// Why there is nothing after some time: the scene became unstable.
  virtual std::optional<std::string> failure() const { return std::nullopt; }
};

/// A scene file, a name of the gallery, "-", or a recording. `threads` 0: all. Error as load_scene_document
/// and RecordingReader have it.
std::unique_ptr<PictureSource> open_source(const std::string& source, const PictureLook& look, int threads);

}  // namespace truestep
