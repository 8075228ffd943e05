// Outlines of the plane as solids for drawing: prisms along z with a bevelled front rim. A disk has a narrow
// notch on its own x axis that shows its rotation; a link of a chain is a strip on its solid side.
#pragma once
#include <memory>

#include "engine/collision/flat/outline.h"
#include "engine/core/drawing.h"

namespace truestep::flat {

/// From z = -depth / 2 to depth / 2 (m > 0); links are `depth` / 4 thick. Rounded corners become chords of at
/// most 0.3 rad.
std::shared_ptr<const DrawnMesh> outline_mesh(const Outline& outline, double depth);

}  // namespace truestep::flat
