#include "engine/systems/rigid2d/drawing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/math/trig.h"

namespace truestep::rigid2d {
namespace {

constexpr double kRim = 0.12;  // part of the inner radius
constexpr int kDiskParts = 32;
constexpr double kNotch = 0.08;  // rad, half of it

/// Outline of a rounded polygon as points, counter-clockwise, moved inwards by `inset`.
std::vector<Vec2> rim(const Outline& s, double inset) {
  std::vector<Vec2> points;
  const double r = s.radius;
  if (s.corners == 1) {
    // A narrow notch on the disk's own x axis shows how it is turned.
    for (int k = 0; k <= kDiskParts; ++k) {
      const double at = kNotch + (2 * std::numbers::pi - 2 * kNotch) * k / kDiskParts;
      const trig::SinCos t = trig::sincos(at);
      points.push_back(s.corner[0] + (r - inset) * Vec2{t.cos, t.sin});
    }
    points.push_back(s.corner[0] + Vec2{0.6 * r, 0});
    return points;
  }
  for (uint32_t i = 0; i < s.corners; ++i) {
    const Vec2 m = s.normal[(i + s.corners - 1) % s.corners], n = s.normal[i];
    if (r <= inset) {
      // Sharp corners move along their bisector, so that every edge moves by the same distance.
      const Vec2 b = flat::unit(m + n);
      const double along = (inset - r) / std::max(0.2, flat::dot(b, n));
      points.push_back(s.corner[i] - along * b);
      continue;
    }
    const double turn = s.corners == 2 ? std::numbers::pi : trig::atan2(flat::cross(m, n), flat::dot(m, n));
    const int parts = std::max(1, static_cast<int>(turn / 0.3));
    for (int k = 0; k <= parts; ++k) {
      const trig::SinCos t = trig::sincos(turn * k / parts);
      points.push_back(s.corner[i] + (r - inset) * (Rotation{t.cos, t.sin} * m));
    }
  }
  return points;
}

struct Pen {
  Drawing& out;
  uint32_t body;

  uint32_t add(Vec2 p, double depth) {
    out.rows.push_back({body, p, depth});
    return static_cast<uint32_t>(out.rows.size() - 1);
  }
  void tile(const Outline& s, double inner, double lift) {
    const double inset = kRim * inner;
    const std::vector<Vec2> low = rim(s, 0), high = rim(s, inset);
    const auto n = static_cast<uint32_t>(std::min(low.size(), high.size()));
    if (low.size() != high.size()) return fan(low, lift);
    const auto first = static_cast<uint32_t>(out.rows.size());
    for (uint32_t i = 0; i < n; ++i) add(low[i], lift);
    for (uint32_t i = 0; i < n; ++i) add(high[i], lift + inset);
    const uint32_t middle = add(s.center, lift + inset);
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t j = (i + 1) % n;
      out.topology.triangles.push_back({first + i, first + j, first + n + j});
      out.topology.triangles.push_back({first + i, first + n + j, first + n + i});
      out.topology.triangles.push_back({middle, first + n + i, first + n + j});
    }
  }
  void fan(const std::vector<Vec2>& points, double lift) {
    const auto first = static_cast<uint32_t>(out.rows.size());
    for (const Vec2 p : points) add(p, lift);
    for (uint32_t i = 1; i + 1 < points.size(); ++i)
      out.topology.triangles.push_back({first, first + i, first + i + 1});
  }
  /// A link of a chain is a thin strip below its line.
  void strip(const Outline& s, double thick) {
    const Vec2 down = -thick * s.normal[0];
    fan({s.corner[0], s.corner[0] + down, s.corner[1] + down, s.corner[1]}, 0);
  }
};

}  // namespace

Drawing draw(const Model& model, const std::optional<Vec3>& color) {
  Drawing d;
  for (uint32_t i = 0; i < model.count(); ++i) d.rows.push_back({i, {}, 0});
  for (const Shape& s : model.shapes) {
    Pen pen{d, s.body};
    // Sensors lie behind, so that what they watch is seen.
    const double lift = model.bodies[s.body].sensor ? -0.3 * model.size : 0;
    if (s.outline.is_link()) {
      pen.strip(s.outline, 0.1 * model.size);
    } else {
      pen.tile(s.outline, flat::inner_radius(s.outline), lift);
    }
  }
  for (const auto& t : d.topology.triangles) {
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = t[k], b = t[(k + 1) % 3];
      if (d.rows[a].depth == d.rows[b].depth && (b == a + 1)) {
        d.topology.lines.push_back({a, b});
        d.topology.line_kinds.push_back(LineKind::other);
      }
    }
  }
  if (color) d.topology.color = {color->x, color->y, color->z};
  return d;
}

}  // namespace truestep::rigid2d
