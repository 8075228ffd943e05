// What a picture of several systems needs beside each of them: the field that colours a part, one range for
// the colours of all, and a name above each where colours do not tell them apart.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/session/world/frame_values.h"
#include "engine/session/world/world.h"
#include "engine/sinks/picture/draw/draw_list.h"

namespace truestep {

/// Magnitude of each row: the length of a vector, or the value of a scalar field.
std::vector<float> magnitudes(const std::vector<float>& values, uint32_t width);

/// The field that colours a part. "speed" is understood for everything that has velocities.
std::optional<size_t> color_field(const PartInfo& part, const std::string& color_by);

/// The least and greatest finite value over all parts that are coloured, other than grids, or of kinds; empty
/// unless there are several, which one colour bar explains. Values of lines, triangles and joints count where
/// their points have no such field.
std::vector<double> common_range(const World& world, const Frame& frame, const ViewerParams& viewer);

/// A system as a picture names it.
struct NamedSystem {
  std::string name;
  Vec3 place;  ///< m; above the middle of its points
};

/// The middle of the finite points of `set`, at the height of the highest; empty without any.
std::optional<Vec3> name_place(const DrawPoints& set, const Vec3& up);

/// Names above two to eight systems; none above others.
void add_names(DrawList& list, const std::vector<NamedSystem>& systems);

}  // namespace truestep
