// How pictures show grids: in one dimension a curve; in the plane colours, or a surface whose height is the
// value; in space a slice, or a few translucent ones. On request with contours, arrows and streamlines.
#pragma once
#include <string>

#include "engine/scene/scene.h"
#include "engine/session/world/frame_values.h"
#include "engine/sinks/picture/draw/draw_list.h"

namespace truestep {

/// Appends the grid of `part` with the values of its field `field`; for a vector field, colours show the
/// magnitude.
void add_grid(DrawList& list, const PartInfo& part, size_t field, const FrameValues& values,
              const ViewerParams& viewer);

/// The side from which to view a grid of this part; empty when obliquely from above is best.
std::optional<Vec3> facing_side(const PartInfo& part, const ViewerParams& viewer);

}  // namespace truestep
