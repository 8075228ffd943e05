#include "engine/sinks/picture/draw_bodies.h"

#include <algorithm>
#include <cmath>

#include "engine/math/quaternion.h"
#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/geometry.h"

namespace truestep {
namespace {

using Motion = DrawnBodies::Motion;

constexpr Color kFixed{0.70f, 0.715f, 0.735f}, kDriven{0.53f, 0.60f, 0.70f}, kSensor{0.35f, 0.62f, 0.75f};
constexpr float kShade = 0.09f;  // by which neighbours of one colour differ
constexpr double kWide = 2.5;    // a fixed body this many times wider than all that moves is a floor
constexpr Color kContact{0.86f, 0.13f, 0.13f}, kHinge{0.10f, 0.45f, 0.85f}, kBall{0.05f, 0.60f, 0.35f},
    kSlider{0.80f, 0.45f, 0.05f}, kWeld{0.45f, 0.20f, 0.60f}, kRope{0.15f, 0.15f, 0.18f};

Color mixed(const Color& a, const Color& b, float t) {
  return {a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t};
}

/// A number in [-1, 1] that neighbouring rows do not share.
float shade_of(uint32_t row) {
  const uint32_t h = (row + 1) * 2654435761u;
  return static_cast<float>(h >> 8) / 8388608.0f - 1.0f;
}

Color color_of(const DrawnBodies::Form& form, uint32_t row) {
  if (form.color) {
    const auto& c = *form.color;
    return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
  }
  switch (form.motion) {
    case Motion::fixed:
      return kFixed;
    case Motion::driven:
      return kDriven;
    case Motion::sensor:
      return kSensor;
    case Motion::moving:
      break;
  }
  const float shade = kShade * shade_of(row);
  return mixed(picture::palette(form.group), shade > 0 ? Color{1, 1, 1} : Color{0, 0, 0}, std::abs(shade));
}

Color asleep_of(const Color& c) {
  const float grey = 0.3f * c.r + 0.59f * c.g + 0.11f * c.b;
  return mixed(mixed(c, {grey, grey, grey}, 0.4f), {0.30f, 0.32f, 0.36f}, 0.3f);
}

/// A field by name, empty where the system has none.
struct Rows {
  std::vector<double> scratch;
  FieldView view;
  Rows(const System& system, const State& state, std::string_view name) {
    const auto infos = system.fields();
    for (size_t f = 0; f < infos.size(); ++f) {
      if (infos[f].name == name) view = system.field(state, f, scratch);
    }
  }
  double at(size_t i) const {
    if (view.type == Scalar::f64) return static_cast<const double*>(view.data)[i];
    if (view.type == Scalar::f32) return static_cast<const float*>(view.data)[i];
    return static_cast<const uint32_t*>(view.data)[i];
  }
  bool has(size_t row, uint32_t width) const { return view.width == width && row < view.rows; }
};

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

/// A camera that nobody gave looks at what moves and at what is not much wider.
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

void add_bodies(DrawList& list, const System& system, const State& state, const DrawPoints& values) {
  const DrawnBodies bodies = system.bodies(state);
  if (bodies.places.empty()) return;
  const Rows position(system, state, "position"), orientation(system, state, "orientation");
  const Rows asleep(system, state, "asleep");
  const auto [low, high] = picture::scalar_range(values);
  std::vector<DrawShape> shapes;
  std::vector<Motion> motions;
  for (const auto& [row, which] : bodies.places) {
    if (which >= bodies.forms.size() || !position.has(row, 3) || !orientation.has(row, 4)) continue;
    const DrawnBodies::Form& form = bodies.forms[which];
    const Vec3 x{position.at(3 * row), position.at(3 * row + 1), position.at(3 * row + 2)};
    const Quat q{orientation.at(4 * row), orientation.at(4 * row + 1), orientation.at(4 * row + 2),
                 orientation.at(4 * row + 3)};
    const auto& o = form.shape.orientation;
    const Quat turned = normalized(q * Quat{o[0], o[1], o[2], o[3]});
    DrawShape s;
    s.kind = form.shape.kind, s.size = form.shape.size, s.mesh = form.shape.mesh;
    s.position = x + rotation(q).apply(form.shape.position);
    s.orientation[0] = turned.w, s.orientation[1] = turned.x, s.orientation[2] = turned.y,
    s.orientation[3] = turned.z;
    s.container = form.motion == Motion::sensor;
    Color color = color_of(form, row);
    if (row < values.scalar.size() && form.motion == Motion::moving)
      color =
          picture::map_color(values.color_map, high > low ? (values.scalar[row] - low) / (high - low) : 0);
    else if (asleep.has(row, 1) && asleep.at(row) != 0)
      color = asleep_of(color);
    s.color = color;
    shapes.push_back(std::move(s));
    motions.push_back(form.motion);
  }
  frame(shapes, motions);
  list.shapes.insert(list.shapes.end(), shapes.begin(), shapes.end());
}

void add_marks(DrawList& list, const System& system, const State& state, Overlay wish, double size) {
  const Vec3 dot = list.up * (0.05 * size);
  const auto line = [&](const Vec3& a, const Vec3& b, const Color& c, double radius) {
    list.marks.push_back({a, b, c, radius});
  };
  if (shows(wish, Overlay::joints)) {
    for (const JointMark& j : system.joint_marks(state)) {
      const Color color = j.kind == JointMark::Kind::hinge    ? kHinge
                          : j.kind == JointMark::Kind::ball   ? kBall
                          : j.kind == JointMark::Kind::slider ? kSlider
                          : j.kind == JointMark::Kind::fixed  ? kWeld
                                                              : kRope;
      line(j.a, j.b, color, 0.02 * size);
      for (const Vec3& end : {j.a, j.b}) line(end - dot, end + dot, color, 0.05 * size);
      const Vec3 arm = j.axis * (0.35 * size);
      if (norm2(arm) > 0) line(j.a - arm, j.a + arm, color, 0.02 * size);
    }
  }
  if (!shows(wish, Overlay::contacts)) return;
  const std::vector<ContactMark> contacts = system.contact_marks(state);
  double most = 0;
  for (const ContactMark& c : contacts) most = std::max(most, c.force);
  for (const ContactMark& c : contacts) {
    line(c.point - dot * 0.5, c.point + dot * 0.5, kContact, 0.025 * size);
    line(c.point, c.point + c.normal * (size * c.force / most), kContact, 0.012 * size);
  }
}

}  // namespace truestep
