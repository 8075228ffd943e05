// Names of single rows, and the time, in a picture's words.
#pragma once
#include <string>

#include "engine/session/world/frame.h"
#include "engine/session/world/world.h"
#include "engine/sinks/picture/draw/draw_list.h"

namespace truestep {

/// A name beside every row of points that a probe of the scene watches.
void add_probe_labels(DrawList& list, const World& world, const Frame& frame);

/// "t = 1.250 s", or in the unit of which a run of `duration` s takes neither thousands nor thousandths:
/// atoms move in picoseconds, planets in years.
std::string time_text(double time, double duration);

}  // namespace truestep
