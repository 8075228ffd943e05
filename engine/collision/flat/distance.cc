#include "engine/collision/flat/distance.h"

#include <algorithm>
#include <cmath>

#include "engine/math/trig.h"

namespace truestep::flat {
namespace {

struct Vertex {
  Vec2 p, q, w;  // of a, of b, q - p
  uint32_t i = 0, j = 0;
  double weight = 1;
};

uint32_t support(const Outline& s, Vec2 d) {
  uint32_t best = 0;
  double far = dot(s.corner[0], d);
  for (uint32_t i = 1; i < s.corners; ++i) {
    const double x = dot(s.corner[i], d);
    if (x > far) far = x, best = i;
  }
  return best;
}

struct Simplex {
  Vertex v[3];
  int count = 0;

  void keep(std::initializer_list<int> which, std::initializer_list<double> weights) {
    Vertex chosen[3];
    int n = 0;
    auto weight = weights.begin();
    for (const int k : which) chosen[n] = v[k], chosen[n++].weight = *weight++;
    std::copy(chosen, chosen + n, v);
    count = n;
  }
  /// Nearest point to the origin of the edge between vertices a and b.
  void edge(int a, int b) {
    const Vec2 e = v[b].w - v[a].w;
    const double along = -dot(v[a].w, e), length2 = dot(e, e);
    if (along <= 0) return keep({a}, {1});
    if (along >= length2) return keep({b}, {1});
    const double s = along / length2;
    keep({a, b}, {1 - s, s});
  }
  /// Reduces to the feature with the nearest point; true when the origin is inside.
  bool reduce() {
    if (count == 2) {
      edge(0, 1);
    } else if (count == 3) {
      const double area = cross(v[1].w - v[0].w, v[2].w - v[0].w), sign = area < 0 ? -1 : 1;
      // Outside at least one edge; takes the nearest of the candidates.
      Simplex best;
      double least = HUGE_VAL;
      bool outside = false;
      for (int k = 0; k < 3; ++k) {
        const int b = (k + 1) % 3;
        if (sign * cross(v[b].w - v[k].w, -v[k].w) > 0 && area != 0) continue;
        outside = true;
        Simplex candidate = *this;
        candidate.edge(k, b);
        const Vec2 p = candidate.nearest();
        if (dot(p, p) < least) least = dot(p, p), best = candidate;
      }
      if (!outside) return true;
      *this = best;
    }
    return false;
  }
  Vec2 nearest() const {
    Vec2 p;
    for (int k = 0; k < count; ++k) p = p + v[k].weight * v[k].w;
    return p;
  }
};

}  // namespace

CoreDistance core_distance(const Outline& a, const Outline& b) {
  Simplex s;
  const auto vertex = [&](uint32_t i, uint32_t j) {
    return Vertex{a.corner[i], b.corner[j], b.corner[j] - a.corner[i], i, j, 1};
  };
  s.v[0] = vertex(0, 0), s.count = 1;
  Simplex best;
  double least = HUGE_VAL;
  for (int round = 0; round < 24; ++round) {
    if (s.reduce()) return {};
    const Vec2 near = s.nearest();
    const double near2 = dot(near, near);
    if (near2 < 1e-28) return {};
    // Of parallel edges, a further corner is on the line of those two that are known already; where edges are
    // long, rounding makes it look nearer again and again. What brings nothing nearer ends the search.
    if (!(near2 < least)) break;
    best = s, least = near2;
    const Vertex next = vertex(support(a, near), support(b, -near));
    const bool seen =
        std::any_of(s.v, s.v + s.count, [&](const Vertex& v) { return v.i == next.i && v.j == next.j; });
    if (seen || near2 - dot(near, next.w) <= 1e-14 * near2) break;
    s.v[s.count++] = next;
  }
  Vec2 p, q;
  for (int k = 0; k < best.count; ++k)
    p = p + best.v[k].weight * best.v[k].p, q = q + best.v[k].weight * best.v[k].q;
  return {norm(q - p), p, q, best.v[0].i, best.v[0].j};
}

Distance distance(const Outline& a, const Outline& b, const Pose& b_in_a) {
  const CoreDistance core = core_distance(a, moved(b, b_in_a));
  if (!(core.distance > 0)) return {};
  const Vec2 n = (1 / core.distance) * (core.on_b - core.on_a);
  return {std::max(0.0, core.distance - a.radius - b.radius), core.on_a + a.radius * n,
          core.on_b - b.radius * n, n};
}

bool overlap(const Outline& a, const Outline& b, const Pose& b_in_a) {
  return !(distance(a, b, b_in_a).distance > 0);
}

std::optional<RayHit> ray_cast(const Outline& s, Vec2 origin, Vec2 ray) {
  const double r = s.radius, length2 = dot(ray, ray);
  std::optional<RayHit> best;
  const auto offer = [&](double f, Vec2 n) {
    if (f >= 0 && f <= 1 && (!best || f < best->fraction)) best = RayHit{f, n};
  };
  if (!s.is_link()) {
    const Outline point = circle(0, origin);
    if (overlap(s, point, Pose{})) return std::nullopt;
  }
  for (uint32_t i = 0; i < s.corners && s.corners > 1; ++i) {
    if (s.side == Outline::Side::left && i > 0) break;
    const Vec2 n = s.normal[i], v = s.corner[i] + r * n, e = s.corner[(i + 1) % s.corners] - s.corner[i];
    const double down = dot(n, ray);
    if (!(down < 0)) continue;
    const double f = dot(n, v - origin) / down, along = dot(e, origin + f * ray - v);
    if (along >= 0 && along <= dot(e, e)) offer(f, n);
  }
  for (uint32_t i = 0; i < s.corners && r > 0 && length2 > 0; ++i) {
    const Vec2 m = origin - s.corner[i];
    const double b = dot(m, ray), discriminant = b * b - length2 * (dot(m, m) - r * r);
    if (discriminant < 0) continue;
    const double f = (-b - std::sqrt(discriminant)) / length2;
    offer(f, (1 / r) * (m + f * ray));
  }
  return best;
}

Pose Sweep::at(double f) const {
  const trig::SinCos turn = trig::sincos(f * angle);
  const Rotation q{from.q.c * turn.cos - from.q.s * turn.sin, from.q.s * turn.cos + from.q.c * turn.sin};
  return {from.p + f * shift, q};
}

std::optional<Impact> time_of_impact(const Outline& a, const Sweep& move_a, const Outline& b,
                                     const Sweep& move_b, double gap) {
  const double turning = std::abs(move_a.angle) * reach(a, {}) + std::abs(move_b.angle) * reach(b, {});
  const Vec2 slide = move_b.shift - move_a.shift;
  const double tolerance = 1e-3 * gap + 1e-12;
  double f = 0;
  Vec2 normal = unit(-slide);
  // An advance that shrinks to nothing without arriving ends early, which only stops the pair too soon.
  for (int round = 0; round < 200; ++round) {
    const Pose pa = move_a.at(f);
    const Distance d = distance(a, b, pa.to(move_b.at(f)));
    if (d.normal == Vec2{}) return Impact{f, normal};
    normal = pa.q * d.normal;
    if (d.distance <= gap + tolerance) return Impact{f, normal};
    // The fastest that the gap can close: the nearest points along the normal, everything else by rotation.
    const double closing = -dot(slide, normal) + turning;
    if (!(closing > 0)) return std::nullopt;
    f += (d.distance - gap) / closing;
    if (f > 1) return std::nullopt;
  }
  return Impact{f, normal};
}

Box swept_box(const Outline& s, const Sweep& sweep, double reach) {
  Box box = bounds(s, sweep.from);
  box.cover(bounds(s, sweep.at(1)));
  // In between, a turning outline stays within its reach of the path of the pivot.
  if (sweep.angle != 0) box = box.grown(reach * std::min(1.0, std::abs(sweep.angle)));
  box.low.z = box.high.z = 0;
  return box;
}

}  // namespace truestep::flat
