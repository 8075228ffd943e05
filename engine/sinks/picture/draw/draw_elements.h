// Values without a place of their own as colours of what belongs to them: lines, triangles, marks of joints.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/session/world/frame_values.h"
#include "engine/session/world/world.h"
#include "engine/sinks/picture/draw/draw_list.h"

namespace truestep {

/// The field `color_by` of the values that are shown by `which` of the part `drawn`, a main part.
std::optional<FieldPlace> element_field(const World& world, size_t drawn, PartInfo::Elements which,
                                        const std::string& color_by);

/// What a frame must hold for the colours of lines, triangles and joints.
std::vector<FieldPlace> element_fields(const World& world, const std::string& color_by);

/// Magnitudes of a field's values; one per row.
std::vector<float> element_values(const World& world, const Frame& frame, FieldPlace at);

/// Entries of `values` at `rows`; not a number where there is none.
std::vector<float> picked(const std::vector<float>& values, const std::vector<uint32_t>& rows);

/// A colour per joint mark of the frame, by the field `viewer.color_by` of the joints' values; empty for
/// marks without a value. Sets the scale of the list's marks if there is one.
std::vector<std::optional<Color>> joint_colors(DrawList& list, const World& world, const Frame& frame,
                                               const ViewerParams& viewer);

}  // namespace truestep
