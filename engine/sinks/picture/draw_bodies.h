// Bodies of a system as shapes of a draw list: placed, coloured, asleep or awake; contacts and joints as
// marks.
#pragma once
#include "engine/core/overlay.h"
#include "engine/core/system.h"
#include "engine/sinks/picture/draw_list.h"

namespace truestep {

/// Appends the system's bodies. `values` colour them row by row where there is one per row, else their own
/// colour does, or that of their group. Sleeping bodies are paler and darker.
void add_bodies(DrawList& list, const System& system, const State& state, const DrawPoints& values);

/// Appends contacts (a point, and a line along the normal as long as the force) and joints (their ends, and
/// their axis). `size` is the length of the longest line, m.
void add_marks(DrawList& list, const System& system, const State& state, Overlay wish, double size);

}  // namespace truestep
