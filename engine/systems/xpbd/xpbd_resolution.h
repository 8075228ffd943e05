// How the shapes of position-based dynamics are divided more finely while the object stays the same.
#pragma once
#include "engine/core/def/resolution.h"

namespace truestep::xpbd {

/// Counts of links, points and cells of a rope, a coil, hair, a cloth grid and a block. Refused, with the
/// reason: meshes, a mass per point, scheme pbd, tearing, and points named by index.
const Resolution& xpbd_resolution();

}  // namespace truestep::xpbd
