// The constant part of a world's drawing as a recording keeps it, and back.
#pragma once
#include <span>

#include "engine/core/drawing.h"
#include "engine/sinks/recording/file/layout.h"

namespace truestep {

/// The shapes of `parts` (in the layout's order; null: none) and of obstacles, which come as one more part
/// whose rows they are, unless there are none.
RecordedDrawing recorded_drawing(std::span<const PartDrawing* const> parts,
                                 std::span<const DrawnShape> obstacles);

/// Visuals, instances and the points' radius of a recorded part; lines and triangles stay as they are.
void restore_shapes(const RecordedDrawing& drawing, size_t part, PartDrawing& out);

}  // namespace truestep
