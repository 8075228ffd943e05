// What colours mean: the colour map that suits a field, the names of kinds, and the range and label of a
// colour bar.
#pragma once
#include <string>

#include "engine/core/part.h"
#include "engine/scene/scene.h"
#include "engine/sinks/picture/draw/draw_list.h"

namespace truestep {

/// What stands beside the colour bar of a field: the scene's legend if it speaks of that field, or its name,
/// and the unit.
std::string label_of(const ViewerParams& viewer, const std::string& name, const std::string& unit);

/// The map that the scene chose, or else the one that suits the field.
ColorMap map_for(const ViewerParams& viewer, const FieldInfo& field);

/// Gives `set` the map, the range, the kinds and the label by which it shows a field that is called `name`.
void apply_scale(DrawPoints& set, const ViewerParams& viewer, const FieldInfo& field,
                 const std::string& name);

/// A row of the legend for each kind that occurs in the list's points.
void add_kinds_legend(DrawList& list);

}  // namespace truestep
