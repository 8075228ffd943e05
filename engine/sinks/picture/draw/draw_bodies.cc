#include "engine/sinks/picture/draw/draw_bodies.h"

#include <algorithm>
#include <cmath>

#include "engine/math/quaternion.h"
#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/geometry.h"

namespace truestep {
namespace {

using Motion = Visual::Motion;

constexpr Color kFixed{0.70f, 0.715f, 0.735f}, kKinematic{0.53f, 0.60f, 0.70f}, kSensor{0.35f, 0.62f, 0.75f};
constexpr float kShade = 0.09f;  // by which neighbours of the same colour differ
constexpr double kWide = 2.5;    // a fixed body this many times wider than everything that moves is a floor
constexpr Color kContact{0.86f, 0.13f, 0.13f}, kRevolute{0.10f, 0.45f, 0.85f},
    kSpherical{0.05f, 0.60f, 0.35f}, kPrismatic{0.80f, 0.45f, 0.05f}, kWeld{0.45f, 0.20f, 0.60f};

/// A number in [-1, 1] that differs between neighbouring rows.
float shade_of(uint32_t row) {
  const uint32_t h = (row + 1) * 2654435761u;
  return static_cast<float>(h >> 8) / 8388608.0f - 1.0f;
}

Color color_of(const Visual& visual, uint32_t row, size_t first) {
  if (visual.color) {
    const auto& c = *visual.color;
    return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
  }
  switch (visual.motion) {
    case Motion::fixed:
      return kFixed;
    case Motion::kinematic:
      return kKinematic;
    case Motion::sensor:
      return kSensor;
    case Motion::dynamic:
      break;
  }
  const float shade = kShade * shade_of(row);
  return mixed(picture::palette(first + visual.group), shade > 0 ? Color{1, 1, 1} : Color{0, 0, 0},
               std::abs(shade));
}

Color asleep_of(const Color& c) {
  const float grey = 0.3f * c.r + 0.59f * c.g + 0.11f * c.b;
  return mixed(mixed(c, {grey, grey, grey}, 0.4f), {0.30f, 0.32f, 0.36f}, 0.3f);
}

double radius_of(const DrawShape& s) {
  if (s.kind == DrawShape::Kind::sphere) return s.size.x;
  if (s.kind == DrawShape::Kind::capsule) return s.size.x + s.size.y;
  if (s.kind == DrawShape::Kind::cylinder) return std::hypot(s.size.x, s.size.y);
  if (s.kind != DrawShape::Kind::mesh) return norm(s.size);
  double r = 0;
  for (size_t i = 0; i + 2 < s.mesh->positions.size(); i += 3) {
    const Vec3f p = load3(s.mesh->positions.data(), i / 3);
    r = std::max(r, norm(Vec3{p.x, p.y, p.z}));
  }
  return r;
}

/// A camera chosen automatically frames what moves and anything not much wider.
void frame(std::vector<DrawShape>& shapes, const std::vector<Motion>& motions) {
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;
  for (size_t i = 0; i < shapes.size(); ++i) {
    if (motions[i] == Motion::fixed) continue;
    const double r = radius_of(shapes[i]);
    const Vec3& p = shapes[i].position;
    low = {std::min(low.x, p.x - r), std::min(low.y, p.y - r), std::min(low.z, p.z - r)};
    high = {std::max(high.x, p.x + r), std::max(high.y, p.y + r), std::max(high.z, p.z + r)};
  }
  const double size = 0.5 * norm(high - low);
  if (!std::isfinite(size)) return;
  for (size_t i = 0; i < shapes.size(); ++i) {
    if (motions[i] == Motion::fixed && radius_of(shapes[i]) > kWide * size)
      shapes[i].framing = DrawShape::Framing::ignored;
  }
}

}  // namespace

std::optional<Color> bodies_color(const PartDrawing& drawing, size_t first) {
  std::optional<Color> all;
  for (const auto& [row, which] : drawing.instances) {
    if (which >= drawing.visuals.size() || drawing.visuals[which].motion != Motion::dynamic) continue;
    const Visual& visual = drawing.visuals[which];
    const Color one = visual.color ? color_of(visual, row, first) : picture::palette(first + visual.group);
    if (all && (all->r != one.r || all->g != one.g || all->b != one.b)) return std::nullopt;
    all = one;
  }
  return all;
}

void add_bodies(DrawList& list, const PartDrawing& drawing, const Poses& poses, const DrawPoints& values,
                size_t first) {
  const auto& [position, orientation, asleep] = poses;
  const auto [low, high] = picture::scalar_range(values);
  const picture::Paper paper = picture::paper_of(list.background_bottom);
  std::vector<DrawShape> shapes;
  std::vector<Motion> motions;
  for (const auto& [row, which] : drawing.instances) {
    if (which >= drawing.visuals.size() || !position.has(row, 3) || !orientation.has(row, 4)) continue;
    const Visual& visual = drawing.visuals[which];
    const Vec3 x{position.at(3 * row), position.at(3 * row + 1), position.at(3 * row + 2)};
    const Quat q{orientation.at(4 * row), orientation.at(4 * row + 1), orientation.at(4 * row + 2),
                 orientation.at(4 * row + 3)};
    const auto& o = visual.shape.orientation;
    const Quat turned = normalized(q * Quat{o[0], o[1], o[2], o[3]});
    DrawShape s;
    s.kind = visual.shape.kind, s.size = visual.shape.size, s.mesh = visual.shape.mesh;
    s.position = x + rotation(q).apply(visual.shape.position);
    s.orientation[0] = turned.w, s.orientation[1] = turned.x, s.orientation[2] = turned.y,
    s.orientation[3] = turned.z;
    s.container = visual.motion == Motion::sensor;
    Color color = color_of(visual, row, first);
    if (row < values.scalar.size() && visual.motion == Motion::dynamic)
      color = picture::color_at(values, high > low ? (values.scalar[row] - low) / (high - low) : 0, paper);
    else if (asleep.has(row, 1) && asleep.at(row) != 0)
      color = asleep_of(color);
    s.color = color;
    shapes.push_back(std::move(s));
    motions.push_back(visual.motion);
  }
  frame(shapes, motions);
  list.shapes.insert(list.shapes.end(), shapes.begin(), shapes.end());
}

void add_marks(DrawList& list, const Drawing& marks, double size,
               const std::vector<std::optional<Color>>& joints) {
  using Kind = JointMark::Kind;
  const Vec3 dot = list.up * (0.05 * size);
  const auto line = [&](const Vec3& a, const Vec3& b, const Color& c, double radius, bool framed = false) {
    list.marks.push_back({a, b, c, radius, framed});
  };
  for (size_t k = 0; k < marks.joints.size(); ++k) {
    const JointMark& j = marks.joints[k];
    const Color usual = j.kind == Kind::revolute    ? kRevolute
                        : j.kind == Kind::spherical ? kSpherical
                        : j.kind == Kind::prismatic ? kPrismatic
                        : j.kind == Kind::fixed     ? kWeld
                                                    : picture::ink_over(list.background_bottom);
    // A colour that tells a value is what the picture is about: it is large and never outside.
    const bool valued = k < joints.size() && joints[k];
    const Color color = valued ? *joints[k] : usual;
    const double scale = valued ? 3 : 1;
    line(j.a, j.b, color, 0.02 * scale * size, valued);
    for (const Vec3& end : {j.a, j.b})
      line(end - dot * scale, end + dot * scale, color, 0.05 * scale * size, valued);
    const Vec3 arm = j.axis * (0.35 * size);
    if (norm2(arm) > 0) line(j.a - arm, j.a + arm, color, 0.02 * size);
  }
  double most = 0;
  for (const ContactMark& c : marks.contacts) most = std::max(most, c.force);
  for (const ContactMark& c : marks.contacts) {
    line(c.point - dot * 0.5, c.point + dot * 0.5, kContact, 0.025 * size);
    line(c.point, c.point + c.normal * (size * c.force / most), kContact, 0.012 * size);
  }
}

}  // namespace truestep
