// A world's state as a picture's draw list.
#pragma once
#include "engine/session/world.h"
#include "engine/sinks/picture/draw_list.h"

namespace truestep {

/// Points, lines, triangles and obstacles of every system, the scene's camera, ground and a caption.
DrawList draw_list_of(const World& world, const WorldState& state);

}  // namespace truestep
