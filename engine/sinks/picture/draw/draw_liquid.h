// Particles of a liquid as its smooth surface.
#pragma once
#include "engine/sinks/picture/draw/draw_list.h"

namespace truestep {

/// Replaces points that have a size and fill space by the surface of the liquid
/// (geometry/particle_surface.h); leaves those with lines or triangles unchanged.
void wrap_liquid(DrawPoints& points, PartDrawing::Space space);

}  // namespace truestep
