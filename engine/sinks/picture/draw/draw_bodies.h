// Bodies of a part as shapes of a draw list: placed, coloured, asleep or awake; contacts and joints as
// marks.
#pragma once
#include "engine/session/world/frame_values.h"
#include "engine/sinks/picture/draw/draw_list.h"

namespace truestep {

/// Positions and orientations of a part's rows, and which of them are asleep.
struct Poses {
  FrameValues position, orientation, asleep;
};

/// Appends the visuals carried by the rows of a part. `values` colour them if there is one per row, otherwise
/// their own colour or that of their group does: the `first` of the palette and those that follow. Sleeping
/// bodies are paler and darker.
void add_bodies(DrawList& list, const PartDrawing& drawing, const Poses& poses, const DrawPoints& values,
                size_t first);

/// The colour of all moving bodies of a part; empty where there are none or several colours.
std::optional<Color> bodies_color(const PartDrawing& drawing, size_t first);

/// Appends contacts (a point, and a line along the normal as long as the force) and joints (their ends, and
/// their axis), in the colours of `joints` where they have one, otherwise in those of their kinds. `size` is
/// the length of the longest line, m.
void add_marks(DrawList& list, const Drawing& marks, double size,
               const std::vector<std::optional<Color>>& joints = {});

}  // namespace truestep
