#include "engine/collision/flat/outline_mesh.h"

#include <algorithm>
#include <numbers>

#include "engine/collision/drawn_mesh.h"
#include "engine/math/trig.h"

namespace truestep::flat {
namespace {

constexpr double kRim = 0.12;  // bevel, as a fraction of the inner radius
constexpr int kDiskParts = 40;
constexpr double kNotch = 0.07;  // rad, half the notch's width
constexpr double kTurn = 2 * std::numbers::pi;

std::vector<Vec2> disk(const Outline& s, double inset) {
  std::vector<Vec2> points;
  const double r = s.radius;
  for (int k = 0; k <= kDiskParts; ++k) {
    const trig::SinCos t = trig::sincos(kNotch + (kTurn - 2 * kNotch) * k / kDiskParts);
    points.push_back(s.corner[0] + (r - inset) * Vec2{t.cos, t.sin});
  }
  points.push_back(s.corner[0] + Vec2{0.6 * r, 0});
  return points;
}

/// The rounded polygon, anticlockwise, every edge moved inwards by `inset`, at most the radius if there is
/// one.
std::vector<Vec2> ring(const Outline& s, double inset) {
  if (s.corners == 1) return disk(s, inset);
  std::vector<Vec2> points;
  for (uint32_t i = 0; i < s.corners; ++i) {
    const Vec2 m = s.normal[(i + s.corners - 1) % s.corners], n = s.normal[i];
    if (s.radius == 0) {
      const Vec2 bisector = unit(m + n);
      points.push_back(s.corner[i] - (inset / std::max(0.2, dot(bisector, n))) * bisector);
      continue;
    }
    const double turn = s.corners == 2 ? std::numbers::pi : trig::atan2(cross(m, n), dot(m, n));
    const int parts = static_cast<int>(turn / 0.3) + 1;
    for (int k = 0; k <= parts; ++k) {
      const trig::SinCos t = trig::sincos(turn * k / parts);
      points.push_back(s.corner[i] + (s.radius - inset) * (Rotation{t.cos, t.sin} * m));
    }
  }
  return points;
}

struct Prism {
  std::vector<Vec3> points;
  std::vector<std::array<uint32_t, 3>> triangles;

  uint32_t level(const std::vector<Vec2>& ring, double z) {
    const auto first = static_cast<uint32_t>(points.size());
    for (const Vec2 p : ring) points.push_back({p.x, p.y, z});
    return first;
  }
  void band(uint32_t low, uint32_t high, uint32_t n) {
    for (uint32_t i = 0, j = 1; i < n; ++i, j = (j + 1) % n) {
      triangles.push_back({low + i, low + j, high + j});
      triangles.push_back({low + i, high + j, high + i});
    }
  }
  enum class Face : uint8_t { front, back };
  void cap(uint32_t ring, uint32_t n, Vec2 middle, Face face) {
    const auto m = static_cast<uint32_t>(points.size());
    points.push_back({middle.x, middle.y, points[ring].z});
    for (uint32_t i = 0, j = 1; i < n; ++i, j = (j + 1) % n) {
      if (face == Face::front) {
        triangles.push_back({m, ring + i, ring + j});
      } else {
        triangles.push_back({m, ring + j, ring + i});
      }
    }
  }
};

}  // namespace

std::shared_ptr<const DrawnMesh> outline_mesh(const Outline& s, double depth) {
  std::vector<Vec2> low, high;
  Vec2 middle = s.center;
  double inset = 0;
  if (s.is_link()) {
    const Vec2 down = -0.25 * depth * s.normal[0];
    low = high = {s.corner[0], s.corner[0] + down, s.corner[1] + down, s.corner[1]};
    middle = 0.5 * (s.corner[0] + s.corner[1] + down);
  } else {
    inset = std::min(kRim * inner_radius(s), 0.4 * depth);
    if (s.radius > 0) inset = std::min(inset, 0.9 * s.radius);
    low = ring(s, 0), high = ring(s, inset);
  }
  const auto n = static_cast<uint32_t>(low.size());
  Prism prism;
  const uint32_t back = prism.level(low, -0.5 * depth);
  const uint32_t side = inset > 0 ? prism.level(low, 0.5 * depth - inset) : prism.level(high, 0.5 * depth);
  const uint32_t front = inset > 0 ? prism.level(high, 0.5 * depth) : side;
  prism.band(back, side, n);
  if (front != side) prism.band(side, front, n);
  prism.cap(front, n, middle, Prism::Face::front);
  prism.cap(back, n, middle, Prism::Face::back);
  return creased_mesh(prism.points, prism.triangles);
}

}  // namespace truestep::flat
