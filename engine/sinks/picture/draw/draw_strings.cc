#include "engine/sinks/picture/draw/draw_strings.h"

#include <map>

#include "engine/math/quaternion.h"
#include "engine/session/world/frame_values.h"
#include "engine/sinks/picture/color_map.h"

namespace truestep {

namespace {

constexpr double kPixels = 2.5;

struct Rows {
  FrameValues position, orientation;
};

}  // namespace

void add_strings(DrawList& list, const World& world, const Frame& frame) {
  std::map<uint32_t, Rows> parts;
  const auto place = [&](const StringEnd& end) -> std::optional<Vec3> {
    if (end.part == StringEnd::kWorld) return end.at;
    const auto [at, fresh] = parts.try_emplace(end.part);
    auto& [position, orientation] = at->second;
    if (fresh) {
      const PartInfo& info = world.parts()[end.part].info();
      position = FrameValues(frame, end.part, info.find(Meaning::position));
      orientation = FrameValues(frame, end.part, info.find(Meaning::orientation));
    }
    if (!position.has(end.row, 3)) return std::nullopt;
    const size_t p = 3 * size_t{end.row}, q = 4 * size_t{end.row};
    const Vec3 x{position.at(p), position.at(p + 1), position.at(p + 2)};
    if (!orientation.has(end.row, 4)) return x + end.at;
    const Quat turn{orientation.at(q), orientation.at(q + 1), orientation.at(q + 2), orientation.at(q + 3)};
    return x + rotation(turn).apply(end.at);
  };
  DrawPoints set;
  set.color = mixed(list.background_bottom, picture::ink_over(list.background_bottom), 0.8f);
  set.line_pixels = kPixels;
  for (const DrawnString& string : frame.constant->strings) {
    const auto a = place(string.a), b = place(string.b);
    if (!a || !b || norm2(*b - *a) == 0) continue;
    const auto first = static_cast<uint32_t>(set.positions.size() / 3);
    for (const Vec3& p : {*a, *b}) {
      for (const double c : {p.x, p.y, p.z}) set.positions.push_back(static_cast<float>(c));
    }
    set.lines.insert(set.lines.end(), {first, first + 1});
  }
  if (!set.lines.empty()) list.points.push_back(std::move(set));
}

}  // namespace truestep
