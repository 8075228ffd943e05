#include "engine/collision/flat/outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/errors.h"
#include "engine/math/trig.h"

namespace truestep::flat {
namespace {

void set_normals(Outline& s) {
  for (uint32_t i = 0; i < s.corners; ++i) {
    const Vec2 edge = s.corner[(i + 1) % s.corners] - s.corner[i];
    s.normal[i] = unit(right_of(edge), {0, 1});
  }
}

[[noreturn]] void refuse(const std::string& why) {
  throw Error("scene_invalid", why, {"", "bad_shape", why, "", "", "", ""});
}

/// Andrew's monotone chain, counter-clockwise, without points on edges.
std::vector<Vec2> hull_of(std::span<const Vec2> points) {
  std::vector<Vec2> p(points.begin(), points.end());
  std::sort(p.begin(), p.end(), [](Vec2 a, Vec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  p.erase(std::unique(p.begin(), p.end()), p.end());
  if (p.size() < 3) return p;
  std::vector<Vec2> hull(2 * p.size());
  size_t n = 0;
  const auto add = [&](Vec2 a, size_t keep) {
    while (n >= keep + 2 && cross(hull[n - 1] - hull[n - 2], a - hull[n - 1]) <=
                                1e-12 * norm(hull[n - 1] - hull[n - 2]) * norm(a - hull[n - 1])) {
      --n;
    }
    hull[n++] = a;
  };
  for (const Vec2 a : p) add(a, 0);
  const size_t lower = n - 1;
  for (size_t i = p.size() - 1; i-- > 0;) add(p[i], lower);
  hull.resize(n - 1);
  return hull;
}

}  // namespace

Outline circle(double radius, Vec2 center) {
  Outline s;
  s.corners = 1, s.corner[0] = s.center = center, s.radius = radius;
  s.normal[0] = {0, 1};
  return s;
}

Outline capsule(Vec2 a, Vec2 b, double radius) {
  if (a == b) return circle(radius, a);
  Outline s;
  s.corners = 2, s.corner[0] = a, s.corner[1] = b, s.radius = radius;
  s.center = 0.5 * (a + b);
  set_normals(s);
  return s;
}

Outline box(double hx, double hy, Vec2 center, Rotation q, double radius) {
  Outline s;
  s.corners = 4, s.radius = radius;
  s.corner = {{{-hx, -hy}, {hx, -hy}, {hx, hy}, {-hx, hy}}};
  s.normal = {{{0, -1}, {1, 0}, {0, 1}, {-1, 0}}};
  return moved(s, {center, q});
}

Outline polygon(std::span<const Vec2> points, double radius) {
  const std::vector<Vec2> hull = hull_of(points);
  if (hull.size() < 3) refuse("the convex hull of these points has no area");
  if (hull.size() > kMostCorners) refuse("the convex hull of these points has more than eight corners");
  Outline s;
  s.corners = static_cast<uint32_t>(hull.size()), s.radius = radius;
  std::copy(hull.begin(), hull.end(), s.corner.begin());
  set_normals(s);
  Outline sharp = s;
  sharp.radius = 0;
  s.center = area_of(sharp).center;
  return s;
}

std::vector<Outline> chain(std::span<const Vec2> p, Ends ends, Outline::Side side) {
  const size_t n = p.size(), links = ends == Ends::loop ? n : n - 1;
  if (n < 2 || (ends == Ends::loop && n < 3)) refuse("a chain needs at least two points, a loop three");
  std::vector<Outline> list;
  for (size_t i = 0; i < links; ++i) {
    const Vec2 a = p[i], b = p[(i + 1) % n];
    if (a == b) refuse("two consecutive points of this chain coincide");
    Outline s = capsule(a, b, 0);
    s.side = side;
    // The left side is the outside.
    s.normal[0] = unit(left_of(b - a));
    s.normal[1] = -s.normal[0];
    const bool first = i == 0 && ends == Ends::open, last = i + 1 == links && ends == Ends::open;
    s.before = first ? a : p[(i + n - 1) % n];
    s.after = last ? b : p[(i + 2) % n];
    s.neighbours = first && last ? Outline::Neighbours::none
                   : first       ? Outline::Neighbours::after
                   : last        ? Outline::Neighbours::before
                                 : Outline::Neighbours::both;
    list.push_back(s);
  }
  return list;
}

Outline reversed(const Outline& link) {
  using N = Outline::Neighbours;
  Outline r = link;
  std::swap(r.corner[0], r.corner[1]), std::swap(r.normal[0], r.normal[1]), std::swap(r.before, r.after);
  r.neighbours = link.neighbours == N::before  ? N::after
                 : link.neighbours == N::after ? N::before
                                               : link.neighbours;
  return r;
}

// One coordinate after the other: gcc 12 would fuse multiply and add for both together (tests/determinism
// checks).
Outline moved(const Outline& s, const Pose& at) {
  const Rotation q = at.q;
  Outline r;
  for (uint32_t i = 0; i < s.corners; ++i) {
    r.corner[i].x = at.p.x + (q.c * s.corner[i].x - q.s * s.corner[i].y);
    r.normal[i].x = q.c * s.normal[i].x - q.s * s.normal[i].y;
  }
  for (uint32_t i = 0; i < s.corners; ++i) {
    r.corner[i].y = at.p.y + (q.s * s.corner[i].x + q.c * s.corner[i].y);
    r.normal[i].y = q.s * s.normal[i].x + q.c * s.normal[i].y;
  }
  r.corners = s.corners, r.radius = s.radius, r.side = s.side, r.neighbours = s.neighbours;
  r.center = at * s.center;
  if (s.is_link()) r.before = at * s.before, r.after = at * s.after;
  return r;
}

Area area_of(const Outline& s) {
  const double r = s.radius;
  if (s.is_link()) return {0, s.center, 0};
  // The polygon itself by triangles around its first corner, then a strip along every edge and, with all
  // corner sectors adding up to a circle, the rounding with each sector at its corner.
  double area = 0, moment = 0;
  Vec2 first;
  const Vec2 o = s.corner[0];
  const auto add = [&](double a, Vec2 c, double about_own_center) {
    area += a, first = first + a * c, moment += about_own_center + a * dot(c, c);
  };
  for (uint32_t i = 1; i + 1 < s.corners; ++i) {
    const Vec2 u = s.corner[i] - o, v = s.corner[i + 1] - o;
    const double a = 0.5 * cross(u, v);
    const Vec2 c = (1.0 / 3) * (u + v);
    add(a, c, a / 6 * (dot(u, u) + dot(u, v) + dot(v, v)) - a * dot(c, c));
  }
  if (r > 0) {
    for (uint32_t i = 0; i < s.corners && s.corners > 1; ++i) {
      const Vec2 a = s.corner[i], b = s.corner[(i + 1) % s.corners];
      const double length = norm(b - a), strip = length * r;
      add(strip, 0.5 * (a + b) - o + (0.5 * r) * s.normal[i], strip * (length * length + r * r) / 12);
    }
    for (uint32_t i = 0; i < s.corners; ++i) {
      // Sector between the normals of the edges before and after the corner.
      const Vec2 m = s.normal[(i + s.corners - 1) % s.corners], n = s.normal[i];
      const double angle = s.corners == 1   ? 2 * std::numbers::pi
                           : s.corners == 2 ? std::numbers::pi
                                            : trig::atan2(cross(m, n), dot(m, n));
      const double a = 0.5 * angle * r * r;
      const Vec2 middle = s.corners == 1 ? Vec2{} : s.corners == 2 ? left_of(m) : unit(m + n);
      const double out = s.corners == 1 ? 0 : 4 * r * trig::sin(0.5 * angle) / (3 * angle);
      // Two corners: the sector bulges away from the other one.
      const Vec2 way = s.corners == 2 ? unit(s.corner[i] - s.corner[1 - i]) : middle;
      add(a, s.corner[i] - o + out * way, a * (0.5 * r * r - out * out));
    }
  }
  if (!(area > 0)) return {0, s.center, 0};
  const Vec2 c = (1 / area) * first;
  return {area, o + c, moment - area * dot(c, c)};
}

Box bounds(const Outline& s, const Pose& at) {
  const Vec2 first = at * s.corner[0];
  Vec2 low = first, high = first;
  for (uint32_t i = 1; i < s.corners; ++i) {
    const Vec2 c = at * s.corner[i];
    low = {c.x < low.x ? c.x : low.x, c.y < low.y ? c.y : low.y};
    high = {c.x > high.x ? c.x : high.x, c.y > high.y ? c.y : high.y};
  }
  return {{low.x - s.radius, low.y - s.radius, 0}, {high.x + s.radius, high.y + s.radius, 0}};
}

double reach(const Outline& s, Vec2 p) {
  double far = 0;
  for (uint32_t i = 0; i < s.corners; ++i) far = std::max(far, norm(s.corner[i] - p));
  return far + s.radius;
}

double inner_radius(const Outline& s) {
  if (s.is_link()) return 0;
  if (s.corners < 3) return s.radius;
  double least = HUGE_VAL;
  for (uint32_t i = 0; i < s.corners; ++i) least = std::min(least, dot(s.normal[i], s.corner[i] - s.center));
  return least + s.radius;
}

}  // namespace truestep::flat
