#include "engine/collision/queries/time_of_impact.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/pairs/distance/gjk.h"
#include "engine/geometry/compound.h"
#include "engine/geometry/height_field.h"

namespace truestep {
namespace {

constexpr int kRounds = 256;

/// One convex part of a moving body.
struct Moving {
  Convex shape;
  Transform place;  // in the body
  const Sweep* sweep = nullptr;
  double reach = 0;  // m, of the core from the body's origin

  Transform at(double t) const { return sweep->at(t) * place; }
};

double core_reach(const Convex& c) {
  switch (c.kind) {
    case SolidKind::sphere:
      return 0;
    case SolidKind::capsule:
      return c.size.y;
    case SolidKind::cylinder:
      return std::sqrt(c.size.x * c.size.x + c.size.y * c.size.y);
    case SolidKind::box:
      return norm(c.size);
    case SolidKind::hull:
      return c.hull->radius;
    case SolidKind::triangle:
      return std::max(
          {norm(c.triangle->corner[0]), norm(c.triangle->corner[1]), norm(c.triangle->corner[2])});
    case SolidKind::plane:
    case SolidKind::mesh:
    case SolidKind::height_field:
    case SolidKind::compound:
      break;
  }
  return 0;
}

Moving moving(const Convex& c, const Transform& place, const Sweep& s) {
  return {c, place, &s, norm(place.position) + core_reach(c)};
}

struct Gap {
  double distance;
  Vec3 normal, on_a, on_b;
};

/// In the world; distance <= 0 when they overlap.
Gap gap_between(const Moving& a, const Transform& ta, const Moving& b, const Transform& tb,
                const Vec3& guess) {
  if (a.shape.kind == SolidKind::plane) {
    const Vec3 n = ta.direction(a.shape.size);
    const Vec3 low = tb.point(b.shape.support(tb.inverse_direction(-n))) - n * b.shape.radius();
    const double d = dot(n, low - ta.position);
    return {d, n, low - n * d, low};
  }
  const CoreDistance d = core_distance(a.shape, b.shape, relative(ta, tb), ta.inverse_direction(guess));
  const Vec3 n = ta.direction(d.normal);
  return {d.distance - a.shape.radius() - b.shape.radius(), n, ta.point(d.point_a) + n * a.shape.radius(),
          ta.point(d.point_b) - n * b.shape.radius()};
}

std::optional<Impact> advance(const Moving& a, const Moving& b, double touch, double earliest,
                              double latest) {
  const double spin = norm(a.sweep->turn) * a.reach + norm(b.sweep->turn) * b.reach;
  const Vec3 approach = a.sweep->move - b.sweep->move;
  double t = earliest;
  Vec3 guess;
  for (int round = 0;; ++round) {
    const Transform ta = a.at(t), tb = b.at(t);
    if (round == 0) guess = tb.point(b.shape.center()) - ta.point(a.shape.center());
    const Gap g = gap_between(a, ta, b, tb, guess);
    if (g.distance <= touch || round == kRounds) {
      return Impact{t, g.normal, (g.on_a + g.on_b) * 0.5, g.distance};
    }
    const double closing = dot(g.normal, approach) + spin;
    if (!(closing > 0)) return std::nullopt;
    // Aims halfway into the touch zone, so that few rounds are needed and the gap stays open.
    t += (g.distance - 0.5 * touch) / closing;
    if (!(t <= latest)) return std::nullopt;
    guess = g.normal;
  }
}

/// visit(Moving, part) for every convex part of a body.
template <class Visit>
void each_part(const Solid& s, const Sweep& sweep, Visit&& visit) {
  if (s.kind != SolidKind::compound) return visit(moving(view(s), {}, sweep), 0u);
  const auto& parts = s.compound->parts();
  for (uint32_t i = 0; i < parts.size(); ++i) visit(moving(view(parts[i].solid), parts[i].place, sweep), i);
}

/// Box, in the frame of a sweeping body, around all positions of another.
Box swept_box(const Solid& b, const Sweep& sb, const Sweep& sa) {
  const Vec3 p0 = sa.at(0).inverse_point(sb.from.position),
             p1 = sa.at(1).inverse_point(sb.from.position + sb.move);
  Box box = Box::nothing();
  box.cover(p0);
  box.cover(p1);
  // The rotation of the frame adds at most the arc.
  return box.grown(bounding_radius(b) + norm(sa.turn) * std::max(norm(p0), norm(p1)));
}

void keep_earlier(const std::optional<Impact>& hit, uint32_t part_a, uint32_t part_b,
                  std::optional<Impact>& best) {
  if (!hit || (best && hit->t >= best->t)) return;
  best = hit;
  best->part_a = part_a, best->part_b = part_b;
}

/// When the centre of a part reaches the front of a triangle; empty when it stays behind.
std::optional<double> first_in_front(const MeshTriangle& triangle, const Sweep& surface, const Moving& part) {
  const auto height = [&](double t) {
    const Vec3 center = surface.at(t).inverse_point(part.at(t).point(part.shape.center()));
    return dot(triangle.normal, center - triangle.corner[0]);
  };
  if (height(0) >= 0) return 0;
  constexpr int kLooks = 8;
  for (int k = 1; k <= kLooks; ++k) {
    double behind = static_cast<double>(k - 1) / kLooks, before = static_cast<double>(k) / kLooks;
    if (height(before) < 0) continue;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (behind + before);
      (height(middle) < 0 ? behind : before) = middle;
    }
    return before;
  }
  return std::nullopt;
}

std::optional<Impact> against_surface(const Solid& a, const Sweep& sa, const Solid& b, const Sweep& sb,
                                      double touch) {
  std::optional<Impact> best;
  const Box box = swept_box(b, sb, sa).grown(touch);
  each_part(b, sb, [&](const Moving& part, uint32_t part_b) {
    const auto test = [&](const MeshTriangle& triangle, uint32_t index) {
      const auto front = first_in_front(triangle, sa, part);
      if (!front) return;
      keep_earlier(advance(moving(view(triangle), {}, sa), part, touch, *front, best ? best->t : 1), index,
                   part_b, best);
    };
    if (a.kind == SolidKind::mesh) {
      a.mesh->tree().overlapping(box, [&](uint32_t i) { test(a.mesh->triangle(i), i); });
    } else {
      a.heights->overlapping(box, [&](uint32_t i) {
        if (const auto triangle = a.heights->triangle(i)) test(*triangle, i);
      });
    }
  });
  return best;
}

bool is_surface(SolidKind k) {
  return k == SolidKind::mesh || k == SolidKind::height_field;
}

}  // namespace

std::optional<Impact> time_of_impact(const Solid& a, const Sweep& sa, const Solid& b, const Sweep& sb,
                                     double touch) {
  const bool fixed_a = is_surface(a.kind) || a.kind == SolidKind::plane,
             fixed_b = is_surface(b.kind) || b.kind == SolidKind::plane;
  if (fixed_a && fixed_b) return std::nullopt;
  if (fixed_b) {
    auto hit = time_of_impact(b, sb, a, sa, touch);
    if (hit) hit->normal = -hit->normal, std::swap(hit->part_a, hit->part_b);
    return hit;
  }
  if (is_surface(a.kind)) return against_surface(a, sa, b, sb, touch);
  std::optional<Impact> best;
  each_part(a, sa, [&](const Moving& pa, uint32_t ia) {
    each_part(b, sb, [&](const Moving& pb, uint32_t ib) {
      keep_earlier(advance(pa, pb, touch, 0, best ? best->t : 1), ia, ib, best);
    });
  });
  return best;
}

}  // namespace truestep
