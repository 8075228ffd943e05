// Streamlines of a plane field that keep apart: a line starts only at some distance from those before it and
// ends where it comes closer to one of them, or to its own beginning, than half of that (Jobard, Lefer 1997,
// "Creating evenly-spaced streamlines of arbitrary density", section 3; seeds lie on a lattice instead of
// beside the lines that there are).
#pragma once
#include "engine/math/streamline.h"

namespace truestep {

/// Lines (points in lattice units) from at most `count` seeds spread over the field, half of the seeds'
/// spacing apart where they start.
std::vector<std::vector<std::array<double, 2>>> even_streamlines(const PlaneField& field, size_t count);

}  // namespace truestep
