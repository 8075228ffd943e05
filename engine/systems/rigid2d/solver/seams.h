// Floors and walls in the plane that are made of several fixed polygons: what slides over their seams must
// not catch on the edges and corners that the neighbours cover.
#pragma once
#include "engine/systems/rigid2d/pairs.h"

namespace truestep::rigid2d {

/// m, by which neighbours may differ in height and still count as one surface.
double flush(const Model& model);

/// True where fixed polygons are so close that they may be one surface.
bool has_seams(const Model& model);

/// Takes contacts with seams out of the touching pairs.
void leave_out_seams(const Model& model, Pairs& pairs);

}  // namespace truestep::rigid2d
