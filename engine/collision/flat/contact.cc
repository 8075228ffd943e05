#include "engine/collision/flat/contact.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/collision/flat/distance.h"
#include "engine/math/wide.h"

namespace truestep::flat {
namespace {

/// An edge of b becomes the reference only if it separates by this fraction of the margin more, so that the
/// choice does not flicker.
constexpr double kEdgeBias = 0.025;
/// Corners of a chain bent by less than this (rad, approximately) count as straight for edges that pass over
/// them.
constexpr double kStraight = 0.01;

struct Axis {
  double separation = -HUGE_VAL;
  uint32_t edge = 0;
};

/// The edge of p with most of q on its outside, and the separation of the sharp polygons.
Axis best_axis_of_any(const Outline& p, const Outline& q) {
  Axis best;
  for (uint32_t i = 0; i < p.corners; ++i) {
    const Vec2 n = p.normal[i];
    double least = dot(n, q.corner[0]);
    for (uint32_t j = 1; j < q.corners; ++j) least = std::min(dot(n, q.corner[j]), least);
    const double s = least - dot(n, p.corner[i]);
    if (s > best.separation) best = {s, i};
  }
  return best;
}

/// x and y of the first four.
struct FourVectors {
  using W = Wide<double>;
  explicit FourVectors(const std::array<Vec2, kMostCorners>& from) {
    W::Raw low, high;
    std::memcpy(&low, from.data(), sizeof low), std::memcpy(&high, from.data() + 2, sizeof high);
    x = W(__builtin_shufflevector(low, high, 0, 2, 4, 6));
    y = W(__builtin_shufflevector(low, high, 1, 3, 5, 7));
  }
  W x, y;
};

/// The same for a polygon of four, the most common case, with an edge in each lane.
Axis best_axis_of_four(const Outline& p, const Outline& q) {
  using W = Wide<double>;
  const FourVectors n(p.normal), corner(p.corner);
  const auto along = [&n](Vec2 a) { return n.x * W(a.x) + n.y * W(a.y); };
  W least = along(q.corner[0]);
  for (uint32_t j = 1; j < q.corners; ++j) least = min(along(q.corner[j]), least);
  const W s = least - (n.x * corner.x + n.y * corner.y);
  Axis best;
  for (uint32_t i = 0; i < 4; ++i) {
    if (s[static_cast<int>(i)] > best.separation) best = {s[static_cast<int>(i)], i};
  }
  return best;
}

Axis best_axis(const Outline& p, const Outline& q) {
  return p.corners == 4 ? best_axis_of_four(p, q) : best_axis_of_any(p, q);
}

/// The edge of q that faces most against n.
uint32_t opposite_edge(const Outline& q, Vec2 n) {
  uint32_t edge = 0;
  double least = HUGE_VAL;
  for (uint32_t j = 0; j < q.corners; ++j) {
    const double d = dot(q.normal[j], n);
    if (d < least) least = d, edge = j;
  }
  return edge;
}

using Reference = Side;

Side other_side(Side s) {
  return s == Side::a ? Side::b : Side::a;
}

/// A feature made of a corner of a and one of b, whichever of them has the reference edge.
uint32_t feature(Reference r, uint32_t on_reference, uint32_t on_other) {
  return r == Reference::a ? on_reference << 8 | on_other : on_other << 8 | on_reference;
}

struct Clip {
  const Outline& p;  // reference
  const Outline& q;
  Reference which;
  double margin;
};

void set_normal(const Clip& c, Vec2 n, Contact& out) {
  out.normal = c.which == Reference::a ? n : -n;
}

/// Corner i of the reference against corner j of the other.
bool corner_corner(const Clip& c, uint32_t i, uint32_t j, Vec2 fallback, Contact& out) {
  const Vec2 d = c.q.corner[j] - c.p.corner[i];
  const double length = norm(d), separation = length - c.p.radius - c.q.radius;
  if (separation > c.margin) return false;
  const Vec2 n = length > 0 ? (1 / length) * d : fallback;
  set_normal(c, n, out);
  out.point[0] = {c.p.corner[i] + 0.5 * (length + c.p.radius - c.q.radius) * n, separation,
                  feature(c.which, i, j)};
  out.face = Face::none;
  out.points = 1;
  return true;
}

enum class Beyond : uint8_t { no, start, end };

/// The end of the reference edge beyond which the facing edge of q lies, and the corner concerned.
Beyond beyond(const Clip& c, uint32_t edge, uint32_t facing, uint32_t& corner) {
  const uint32_t next = edge + 1 < c.p.corners ? edge + 1 : 0,
                 last = facing + 1 < c.q.corners ? facing + 1 : 0;
  const Vec2 v = c.p.corner[edge], t = c.p.corner[next] - v;
  // The facing edge runs the other way: its end is the low one.
  const double low = dot(t, c.q.corner[last] - v), high = dot(t, c.q.corner[facing] - v), length2 = dot(t, t);
  if (high < 0 && low < 0) {
    corner = high >= low ? facing : last;
    return Beyond::start;
  }
  if (low > length2 && high > length2) {
    corner = low <= high ? last : facing;
    return Beyond::end;
  }
  return Beyond::no;
}

/// The facing edge of q, cut to the strip above the reference edge.
bool edge_edge(const Clip& c, uint32_t edge, uint32_t facing, Contact& out) {
  const uint32_t next = edge + 1 < c.p.corners ? edge + 1 : 0,
                 last = facing + 1 < c.q.corners ? facing + 1 : 0;
  const Vec2 v = c.p.corner[edge], n = c.p.normal[edge];
  Vec2 t = c.p.corner[next] - v;
  const double length = norm(t);
  t = (1 / length) * t;
  // Facing edges of two polygons run in opposite directions; a link has its face on the other side of its
  // direction.
  const bool one_way = c.p.is_link() || c.q.is_link();
  const uint32_t low = one_way ? facing : last, high = one_way ? last : facing;
  const Vec2 w0 = c.q.corner[low], w1 = c.q.corner[high];
  const double s0 = dot(t, w0 - v), s1 = dot(t, w1 - v), h0 = dot(n, w0 - v), h1 = dot(n, w1 - v);
  const double radii = c.p.radius + c.q.radius;
  set_normal(c, n, out);
  out.face = c.which == Reference::a ? Face::of_a : Face::of_b;
  out.points = 0;
  const auto add = [&](double s, double h, uint32_t on_p, uint32_t on_q) {
    if (h - radii > c.margin) return;
    const Vec2 at = v + s * t + 0.5 * (h + c.p.radius - c.q.radius) * n;
    // Member by member: a copy of the whole waits for what has just been written of it.
    ContactPoint& point = out.point[out.points++];
    point.at = at, point.separation = h - radii, point.id = feature(c.which, on_p, on_q);
    point.corner_of = s == 0 || s == length ? c.which : other_side(c.which);
  };
  if (c.q.corners == 1) {
    add(s0, h0, edge, low);
    return out.points > 0;
  }
  const double span = s1 - s0;
  double a = s0, ha = h0, b = s1, hb = h1;
  if (span > 0) {
    if (s0 < 0) a = 0, ha = h0 + (h1 - h0) * ((0 - s0) / span);
    if (s1 > length) b = length, hb = h0 + (h1 - h0) * ((length - s0) / span);
  } else if (h1 < h0) {
    // Seen end on: only the nearer corner counts.
    a = s1, ha = h1;
  }
  add(a, ha, edge, low);
  if (span > 0 && b > a) add(b, hb, next, high);
  return out.points > 0;
}

bool against_edge(const Clip& c, uint32_t edge, double separation, Contact& out) {
  const uint32_t facing = c.q.corners == 1 ? 0 : opposite_edge(c.q, c.p.normal[edge]);
  uint32_t corner = 0;
  const Beyond where = beyond(c, edge, facing, corner);
  if (where != Beyond::no && (separation > 0 || c.p.corners == 2)) {
    const uint32_t next = edge + 1 < c.p.corners ? edge + 1 : 0;
    return corner_corner(c, where == Beyond::start ? edge : next, corner, c.p.normal[edge], out);
  }
  return edge_edge(c, edge, facing, out);
}

constexpr uint32_t kNoEdge = 0xffffffff;

/// The edge of p that faces most along n, to rounding. Its neighbour may be bent by hardly more than that.
uint32_t edge_along(const Outline& p, Vec2 n) {
  uint32_t edge = kNoEdge;
  double most = 1 - 1e-9;
  for (uint32_t i = 0; i < p.corners && p.corners > 1; ++i) {
    const double d = dot(p.normal[i], n);
    if (d > most) most = d, edge = i;
  }
  return edge;
}

/// Sharp polygons that are apart but touch by their rounding: decided by the nearest points.
bool rounded(const Outline& a, const Outline& b, const CoreDistance& d, double margin, Contact& out) {
  if (d.distance > margin + a.radius + b.radius) return false;
  const Vec2 n = (1 / d.distance) * (d.on_b - d.on_a);
  const uint32_t on_a = edge_along(a, n), on_b = edge_along(b, -n);
  if (on_a != kNoEdge) {
    return edge_edge({a, b, Reference::a, margin}, on_a, b.corners == 1 ? 0 : opposite_edge(b, n), out);
  }
  if (on_b != kNoEdge) {
    return edge_edge({b, a, Reference::b, margin}, on_b, a.corners == 1 ? 0 : opposite_edge(a, -n), out);
  }
  return corner_corner({a, b, Reference::a, margin}, d.corner_a, d.corner_b, n, out);
}

/// b in the frame of a.
bool convex(const Outline& a, const Outline& b, double margin, Contact& out) {
  const double far = margin + a.radius + b.radius;
  if (a.corners == 1 && b.corners == 1) {
    return corner_corner({a, b, Reference::a, margin}, 0, 0, {0, 1}, out);
  }
  const Axis on_a = a.corners > 1 ? best_axis(a, b) : Axis{};
  if (on_a.separation > far) return false;
  const Axis on_b = b.corners > 1 ? best_axis(b, a) : Axis{};
  if (on_b.separation > far) return false;
  // Two segments that do not overlap may still have no separating axis: one lies beyond the other's end.
  const bool segments = a.corners <= 2 && b.corners <= 2;
  if (a.radius + b.radius > 0 && (segments || std::max(on_a.separation, on_b.separation) > 0)) {
    const CoreDistance d = core_distance(a, b);
    if (d.distance > 0) return rounded(a, b, d, margin, out);
  }
  const bool b_wins =
      a.corners == 1 || (b.corners > 1 && on_b.separation > on_a.separation + kEdgeBias * margin);
  return b_wins ? against_edge({b, a, Reference::b, margin}, on_b.edge, on_b.separation, out)
                : against_edge({a, b, Reference::a, margin}, on_a.edge, on_a.separation, out);
}

bool has(const Outline& link, Outline::Neighbours which) {
  return (static_cast<unsigned>(link.neighbours) & static_cast<unsigned>(which)) != 0;
}

/// Whether a contact at the end corner of the link may have normal n: only between its own normal and the
/// neighbour's.
bool end_takes(const Outline& link, Vec2 n) {
  if (!has(link, Outline::Neighbours::after)) return true;
  const Vec2 onwards = link.after - link.corner[1];
  return cross(link.corner[1] - link.corner[0], onwards) < 0 && cross(left_of(onwards), n) >= 0;
}

/// Whether p is on the left of the chain, judged by this link and its neighbours. Beyond an end, the corner
/// there decides: at an outward corner, left of either link; at an inward one, left of both.
bool on_left(const Outline& link, Vec2 p) {
  const Vec2 a = link.corner[0], b = link.corner[1], along = b - a;
  const bool own = cross(along, p - a) >= 0;
  const auto corner = [&](Vec2 first, Vec2 second, bool other) {
    return cross(first, second) < 0 ? own || other : own && other;
  };
  if (has(link, Outline::Neighbours::before) && dot(p - a, along) < 0) {
    return corner(a - link.before, along, cross(a - link.before, p - a) >= 0);
  }
  if (has(link, Outline::Neighbours::after) && dot(p - b, along) > 0) {
    return corner(along, link.after - b, cross(link.after - b, p - b) >= 0);
  }
  return own;
}

/// One side of a link against b in the frame of the link. Whatever belongs to the corner at its start is left
/// to the earlier link: every corner has one owner.
bool link_touch(const Outline& link, const Outline& b, double margin, Contact& out) {
  const Vec2 a0 = link.corner[0], n = link.normal[0], along = link.corner[1] - a0;
  if (dot(n, b.center - a0) < 0) return false;
  double face = HUGE_VAL;
  for (uint32_t j = 0; j < b.corners; ++j) face = std::min(face, dot(n, b.corner[j] - a0));
  if (face > margin + b.radius) return false;

  if (b.corners > 1) {
    const Axis side = best_axis(b, link);
    if (side.separation > margin + b.radius) return false;
    if (side.separation > face + kEdgeBias * margin) {
      const Vec2 m = -b.normal[side.edge];
      const bool to_end = dot(m, along) > 0;
      const bool open_end = !has(link, to_end ? Outline::Neighbours::after : Outline::Neighbours::before);
      const double turn = to_end ? cross(unit(along), unit(link.after - link.corner[1], unit(along)))
                                 : cross(unit(a0 - link.before, unit(along)), unit(along));
      const Clip c{b, link, Reference::b, margin};
      if (open_end) return against_edge(c, side.edge, side.separation, out);
      if (turn < -kStraight) {
        // An outward corner: handled here at the end if the normal lies within its fan, otherwise by the
        // neighbour.
        return to_end && end_takes(link, m) && against_edge(c, side.edge, side.separation, out);
      }
    }
  }
  const Clip c{link, b, Reference::a, margin};
  const uint32_t facing = b.corners == 1 ? 0 : opposite_edge(b, n);
  uint32_t corner = 0;
  switch (beyond(c, 0, facing, corner)) {
    case Beyond::no:
      return edge_edge(c, 0, facing, out);
    case Beyond::start:
      return !has(link, Outline::Neighbours::before) && corner_corner(c, 0, corner, n, out);
    case Beyond::end:
      break;
  }
  return corner_corner(c, 1, corner, n, out) && end_takes(link, out.normal);
}

/// The side of a link on which b is.
bool link_side_touch(const Outline& link, const Outline& b, double margin, Contact& out) {
  if (link.side == Outline::Side::left || on_left(link, b.center)) return link_touch(link, b, margin, out);
  return link_touch(reversed(link), b, margin, out);
}

}  // namespace

bool touch(const Outline& a, const Outline& b, const Pose& b_in_a, double margin, Contact& out) {
  out.points = 0;
  if (a.is_link() && b.is_link()) return false;
  if (a.is_link() || !b.is_link()) {
    const Outline there = moved(b, b_in_a);
    return a.is_link() ? link_side_touch(a, there, margin, out) : convex(a, there, margin, out);
  }
  // The link is b: work in its frame and transform back.
  const Pose a_in_b = b_in_a.to(Pose{});
  if (!link_side_touch(b, moved(a, a_in_b), margin, out)) return false;
  out.normal = -(b_in_a.q * out.normal);
  if (out.face != Face::none) out.face = out.face == Face::of_a ? Face::of_b : Face::of_a;
  for (uint32_t i = 0; i < out.points; ++i) {
    out.point[i].at = b_in_a * out.point[i].at, out.point[i].corner_of = other_side(out.point[i].corner_of);
  }
  return true;
}

}  // namespace truestep::flat
