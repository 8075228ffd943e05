// A world's state as a picture's draw list.
#pragma once
#include "engine/session/world.h"
#include "engine/sinks/picture/draw_bodies.h"

namespace truestep {

/// Points, lines, triangles, bodies and obstacles of every system, the scene's camera, ground and a caption;
/// contacts and joints where asked for.
DrawList draw_list_of(const World& world, const WorldState& state, Overlay overlay = Overlay::none);

}  // namespace truestep
