// A frame as a picture's draw list.
#pragma once
#include "engine/session/world.h"
#include "engine/sinks/picture/draw_bodies.h"

namespace truestep {

/// What a frame must hold to be drawn, with the contacts or joints that are to be shown.
FrameRequest picture_request(const World& world, Wish marks = Wish::none);

/// Points, lines, triangles, bodies and obstacles of every part, the scene's camera, ground and a caption;
/// the marks that the frame holds.
DrawList draw_list_of(const World& world, const Frame& frame);

}  // namespace truestep
