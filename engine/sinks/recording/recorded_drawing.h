// The constant part of a world's drawing as kept in a recording, and back.
#pragma once
#include <span>

#include "engine/core/drawing.h"
#include "engine/sinks/recording/file/layout.h"

namespace truestep {

/// The shapes of `parts` (in the layout's order; null: none) and of the obstacles, if any, as one more part
/// whose rows they are.
RecordedDrawing recorded_drawing(std::span<const PartDrawing* const> parts,
                                 std::span<const DrawnShape> obstacles);

/// Restores visuals, instances and the point radius of a recorded part; lines and triangles are unchanged.
void restore_shapes(const RecordedDrawing& drawing, size_t part, PartDrawing& out);

}  // namespace truestep
