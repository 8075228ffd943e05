// Bodies of a part as shapes of a draw list: placed, coloured, asleep or awake; contacts and joints as
// marks.
#pragma once
#include "engine/session/frame_values.h"
#include "engine/sinks/picture/draw_list.h"

namespace truestep {

/// Where a part's rows are, how they are turned and which are asleep.
struct Poses {
  FrameValues position, orientation, asleep;
};

/// Appends what the rows of a part carry. `values` colour them row by row where there is one per row, else
/// their own colour does, or that of their group. Sleeping bodies are paler and darker.
void add_bodies(DrawList& list, const PartDrawing& drawing, const Poses& poses, const DrawPoints& values);

/// Appends contacts (a point, and a line along the normal as long as the force) and joints (their ends, and
/// their axis). `size` is the length of the longest line, m.
void add_marks(DrawList& list, const Drawing& marks, double size);

}  // namespace truestep
