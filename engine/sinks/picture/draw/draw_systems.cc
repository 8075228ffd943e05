#include "engine/sinks/picture/draw/draw_systems.h"

#include <algorithm>
#include <cmath>

#include "engine/sinks/picture/draw/draw_scale.h"

namespace truestep {
namespace {

constexpr size_t kNames = 8;  // of more systems none is named

// The part whose lines and triangles the values of part p belong to.
const PartInfo& main_of(const World& world, size_t p) {
  return world.parts()[p - world.parts()[p].index].info();
}

}  // namespace

std::vector<float> magnitudes(const std::vector<float>& values, uint32_t width) {
  std::vector<float> out(values.size() / width);
  for (size_t i = 0; i < out.size(); ++i) {
    float sum = 0;
    for (uint32_t c = 0; c < width; ++c) sum += values[i * width + c] * values[i * width + c];
    out[i] = width == 1 ? values[i] : std::sqrt(sum);
  }
  return out;
}

std::optional<size_t> color_field(const PartInfo& part, const std::string& color_by) {
  if (color_by.empty()) return std::nullopt;
  if (const auto f = part.find(color_by)) return f;
  return color_by == "speed" ? part.find(Meaning::velocity) : std::nullopt;
}

std::vector<double> common_range(const World& world, const Frame& frame, const ViewerParams& viewer) {
  const std::string& color_by = viewer.color_by;
  if (!viewer.names.empty()) return {};
  double low = HUGE_VAL, high = -HUGE_VAL;
  size_t colored = 0;
  for (size_t p = 0; p < world.parts().size(); ++p) {
    const PartInfo& info = world.parts()[p].info();
    const auto f = color_field(info, color_by);
    if (!f || info.kind == PartInfo::Kind::grid || !info.colorable()) continue;
    if (!info.fields[*f].kinds.empty()) return {};
    if (info.kind == PartInfo::Kind::values && color_field(main_of(world, p), color_by)) continue;
    ++colored;
    for (const float v : magnitudes(FrameValues(frame, p, f).floats(), info.fields[*f].width)) {
      if (!std::isfinite(v)) continue;
      low = std::min<double>(low, v), high = std::max<double>(high, v);
    }
    if (map_for(viewer, info.fields[*f]) == ColorMap::balance)
      high = std::max(std::abs(low), std::abs(high)), low = -high;
  }
  return colored > 1 && low <= high ? std::vector<double>{low, high} : std::vector<double>{};
}

std::optional<Vec3> name_place(const DrawPoints& set, const Vec3& up) {
  Vec3 sum;
  double top = -HUGE_VAL, count = 0;
  for (size_t i = 0; i + 2 < set.positions.size(); i += 3) {
    const Vec3 p{set.positions[i], set.positions[i + 1], set.positions[i + 2]};
    if (!std::isfinite(p.x + p.y + p.z)) continue;
    sum = sum + p, ++count;
    top = std::max(top, dot(p, up));
  }
  if (count == 0) return std::nullopt;
  const Vec3 middle = sum * (1 / count);
  return middle + up * (top - dot(middle, up));
}

void add_names(DrawList& list, const std::vector<NamedSystem>& systems) {
  if (systems.size() < 2 || systems.size() > kNames) return;
  for (const NamedSystem& s : systems) list.labels.push_back({s.name, s.place, DrawLabel::Side::above, {}});
}

}  // namespace truestep
