// Particles of a liquid as its smooth surface.
#pragma once
#include "engine/sinks/picture/draw_list.h"

namespace truestep {

/// Puts the surface of the liquid (geometry/particle_surface.h) in the place of points that have a size and
/// fill space; leaves those with lines or triangles as they are.
void wrap_liquid(DrawPoints& points, PartDrawing::Space space);

}  // namespace truestep
