#include "engine/sinks/picture/draw/draw_scale.h"

#include <algorithm>
#include <cmath>

#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/geometry.h"

namespace truestep {

std::string label_of(const ViewerParams& viewer, const std::string& name, const std::string& unit) {
  const std::string& shown = !viewer.legend.empty() && name == viewer.color_by ? viewer.legend : name;
  return unit.empty() || unit == "1" ? shown : shown + " (" + unit + ")";
}

ColorMap map_for(const ViewerParams& viewer, const FieldInfo& field) {
  if (viewer.color_map != ColorMap::automatic) return viewer.color_map;
  const bool deviates = field.scale == FieldInfo::Scale::deviation && field.width == 1;
  return deviates ? ColorMap::balance : ColorMap::viridis;
}

void apply_scale(DrawPoints& set, const ViewerParams& viewer, const FieldInfo& field,
                 const std::string& name) {
  set.color_map = map_for(viewer, field);
  if (const auto& range = viewer.range; !range.empty())
    set.scalar_min = static_cast<float>(range[0]), set.scalar_max = static_cast<float>(range[1]);
  const auto& names = viewer.names.empty() ? field.kinds : viewer.names;
  for (size_t k = 0; k < names.size(); ++k)
    set.kinds.push_back({names[k], picture::color_of_kind(names[k], k)});
  if (names.empty()) {
    set.scalar_label = label_of(viewer, name, field.unit);
  } else if (viewer.range.empty()) {
    set.scalar_min = -0.5f, set.scalar_max = static_cast<float>(names.size()) - 0.5f;
  }
}

void add_kinds_legend(DrawList& list) {
  for (const DrawPoints& set : list.points) {
    if (set.kinds.empty()) continue;
    const auto [low, high] = picture::scalar_range(set);
    std::vector<bool> present(set.kinds.size());
    for (const auto* values : {&set.scalar, &set.line_scalar, &set.triangle_scalar}) {
      for (const float v : *values) {
        const float place = (v - low) / (high - low) * static_cast<float>(present.size());
        if (std::isfinite(place))
          present[static_cast<size_t>(std::clamp(place, 0.0f, static_cast<float>(present.size() - 1)))] =
              true;
      }
    }
    for (size_t k = 0; k < present.size(); ++k) {
      const auto same = [&](const LegendRow& row) { return row.text == set.kinds[k].text; };
      if (present[k] && std::none_of(list.legend.begin(), list.legend.end(), same))
        list.legend.push_back(set.kinds[k]);
    }
  }
}

}  // namespace truestep
