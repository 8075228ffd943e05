// A frame as a picture's draw list.
#pragma once
#include <optional>
#include <string>

#include "engine/session/world/world.h"
#include "engine/sinks/picture/draw/draw_bodies.h"
#include "engine/sinks/picture/draw/trails.h"

namespace truestep {

/// How a picture may differ from the scene's own settings.
struct PictureLook {
  std::optional<std::string> color_by;  ///< name of a field, or empty: no colours
  enum class Theme : uint8_t { light, dark } theme = Theme::light;
  /// Camera position when the scene's own is not wanted: framing everything drawn, from one side of it.
  enum class View : uint8_t { scene, all, front, side, top } view = View::scene;
  Wish marks = Wish::none;
  std::shared_ptr<const TrailSink> trails = {};  ///< kept for the scene while it ran
};

/// Error "bad_request" with the pointer "?color_by", listing the alternatives, when no part has such a field.
void require_color(const World& world, const std::string& color_by);

/// What a frame must hold to be drawn.
FrameRequest picture_request(const World& world, const PictureLook& look = {});

/// Points, lines, triangles, bodies and obstacles of every part, the scene's camera, ground and a caption;
/// and the marks in the frame.
DrawList draw_list_of(const World& world, const Frame& frame, const PictureLook& look = {});

}  // namespace truestep
