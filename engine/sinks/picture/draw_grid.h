// Grids as pictures show them: a curve in one dimension; in the plane colours, or a surface that stands out
// by the value; in space a slice, or a few translucent ones. Level lines, arrows and streamlines over them on
// request.
#pragma once
#include <string>

#include "engine/scene/scene.h"
#include "engine/session/frame_values.h"
#include "engine/sinks/picture/draw_list.h"

namespace truestep {

/// Appends the grid of `part` with the values of its field `field`; of a vector field the colours show the
/// length.
void add_grid(DrawList& list, const PartInfo& part, size_t field, const FrameValues& values,
              const ViewerParams& viewer);

/// Name and unit beside a colour bar; pure numbers have no unit.
std::string label_of(const std::string& name, const std::string& unit);

/// The side to look from at a grid of this part; nothing where obliquely from above is best.
std::optional<Vec3> facing_side(const PartInfo& part, const ViewerParams& viewer);

}  // namespace truestep
