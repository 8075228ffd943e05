#include "engine/sinks/picture/draw/draw_elements.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/draw/draw_scale.h"
#include "engine/sinks/picture/draw/draw_systems.h"
#include "engine/sinks/picture/geometry.h"

namespace truestep {

using Elements = PartInfo::Elements;

std::optional<FieldPlace> element_field(const World& world, size_t drawn, Elements which,
                                        const std::string& color_by) {
  const PartTable& parts = world.parts();
  for (size_t p = 0; p < parts.size() && !color_by.empty() && parts[drawn].index == 0; ++p) {
    if (parts[p].system != parts[drawn].system || parts[p].info().elements != which) continue;
    if (const auto f = parts[p].info().find(color_by)) return FieldPlace{p, *f};
  }
  return std::nullopt;
}

std::vector<FieldPlace> element_fields(const World& world, const std::string& color_by) {
  std::vector<FieldPlace> out;
  for (size_t p = 0; p < world.parts().size(); ++p) {
    for (const Elements which : {Elements::lines, Elements::triangles, Elements::joints}) {
      if (const auto at = element_field(world, p, which, color_by)) out.push_back(*at);
    }
  }
  return out;
}

std::vector<float> element_values(const World& world, const Frame& frame, FieldPlace at) {
  return magnitudes(FrameValues(frame, at.part, at.field).floats(),
                    world.parts()[at.part].info().fields[at.field].width);
}

std::vector<float> picked(const std::vector<float>& values, const std::vector<uint32_t>& rows) {
  std::vector<float> out;
  for (const uint32_t r : rows)
    out.push_back(r < values.size() ? values[r] : std::numeric_limits<float>::quiet_NaN());
  return out;
}

std::vector<std::optional<Color>> joint_colors(DrawList& list, const World& world, const Frame& frame,
                                               const ViewerParams& viewer) {
  const std::vector<JointMark>& joints = frame.moving.joints;
  std::vector<float> values(joints.size(), std::numeric_limits<float>::quiet_NaN());
  DrawPoints scale;  // for its range
  for (const FieldPlace& at : element_fields(world, viewer.color_by)) {
    if (world.parts()[at.part].info().elements != Elements::joints) continue;
    const std::vector<float> rows = element_values(world, frame, at);
    for (size_t k = 0; k < joints.size(); ++k) {
      if (joints[k].part == at.part && joints[k].row < rows.size()) values[k] = rows[joints[k].row];
    }
    scale.kinds.clear();
    apply_scale(scale, viewer, world.parts()[at.part].info().fields[at.field], viewer.color_by);
  }
  std::vector<std::optional<Color>> out(joints.size());
  if (std::none_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); })) return out;
  scale.scalar = values;
  const auto [low, high] = picture::scalar_range(scale);
  for (size_t k = 0; k < joints.size(); ++k) {
    if (!std::isfinite(values[k])) continue;
    const float t = high > low ? std::clamp((values[k] - low) / (high - low), 0.0f, 1.0f) : 0;
    out[k] = picture::color_at(scale, t, picture::paper_of(list.background_bottom));
  }
  list.scale = DrawScale{scale.scalar_label, scale.color_map, low, high};
  return out;
}

}  // namespace truestep
