// Strings between rows of a frame, as lines of a draw list.
#pragma once
#include "engine/session/world/frame.h"
#include "engine/session/world/world.h"
#include "engine/sinks/picture/draw/draw_list.h"

namespace truestep {

/// Appends the frame's strings in the ink of the list's theme; those whose rows are missing from the frame
/// are skipped.
void add_strings(DrawList& list, const World& world, const Frame& frame);

}  // namespace truestep
