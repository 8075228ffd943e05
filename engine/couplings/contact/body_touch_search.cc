#include "engine/couplings/contact/body_touch_search.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/point_distance.h"
#include "engine/collision/queries/time_of_impact.h"
#include "engine/couplings/contact/edge_touch.h"

namespace truestep::contact {

namespace {

/// Fraction of a body's inner radius; a point that moves farther is searched along its path.
constexpr double kFar = 0.5;
/// m; anything closer than this, or than the touch distance, is listed too.
constexpr double kNear = 1e-3;
/// Multiple of its reach at which a corner is examined.
constexpr double kRoom = 1.01;
/// m; conservative advancement stops here at the latest.
constexpr double kTouch = 1e-6;
constexpr size_t kBlock = 512;

bool is_surface(SolidKind k) {
  return k == SolidKind::mesh || k == SolidKind::height_field;
}

/// The sides of a box that another box lies entirely beyond, one bit each.
uint8_t sides(const Box& b, const Box& of) {
  return static_cast<uint8_t>((b.high.x < of.low.x) | (b.low.x > of.high.x) << 1 |
                              (b.high.y < of.low.y) << 2 | (b.low.y > of.high.y) << 3 |
                              (b.high.z < of.low.z) << 4 | (b.low.z > of.high.z) << 5);
}

/// Fraction of the path at which a gap changing from `before` to `after` closes.
double closes_at(double before, double after) {
  if (before <= 0) return 0;
  return after < 0 ? before / (before - after) : 1;
}

}  // namespace

void BodyMemory::store(const ConstBodies& b) {
  poses_.resize(b.count()), start_.resize(b.count());
  for (size_t i = 0; i < b.count(); ++i) {
    poses_[i] = {b.place(i), b.orientation(i)}, start_[i] = {b.velocity(i), b.spin(i)};
  }
}

void BodyMemory::follow(const ConstBodies& b) {
  free_.resize(b.count());
  for (size_t i = 0; i < b.count(); ++i) free_[i] = {b.velocity(i), b.spin(i)};
}

void BodyTouchSearch::place_bodies(const BodyTouchQuery& q) {
  const size_t n = q.bodies.count();
  bodies_.resize(n), boxes_.resize(n);
  unbounded_.clear();
  for (uint32_t i = 0; i < n; ++i) {
    const Solid* solid = q.bodies.form(i).solid;
    boxes_[i] = Box::nothing();
    if (!solid) continue;
    Moving& m = bodies_[i];
    const Pose end{q.bodies.place(i), q.bodies.orientation(i)};
    m.sweep = sweep_between(q.body_start.pose(i), end);
    m.begin = transform_of(q.body_start.pose(i)), m.end = transform_of(end);
    if (solid->kind == SolidKind::plane) {
      unbounded_.push_back(i);
      continue;
    }
    // An arc deviates from its chord by an eighth of the square of the angle, and never by more than the
    // radius.
    const double angle2 = norm2(m.sweep.turn), reach = q.forms[q.form_of[i]].reach;
    m.slack = std::min(0.125 * angle2, 1.0) * reach;
    Box box = bounds(*solid, m.begin);
    box.cover(bounds(*solid, m.end));
    boxes_[i] = box.grown(m.slack + q.reach + std::max(q.reach, kNear));
  }
  grid_.build(boxes_);
  if (q.hulls.size() > 0) place_corners(q);
  if (!q.edges.empty()) place_edges(q);
}

void BodyTouchSearch::place_points(const BodyTouchQuery& q) {
  ways_.resize(q.points.count), sides_.resize(q.points.count);
  for (size_t i = 0; i < q.points.count; ++i) {
    const Vec3 x = load3(q.start.x(), i);
    ways_[i] = {x, x};
    ways_[i].cover(q.points.place(i));
    sides_[i] = sides(ways_[i], corner_bounds_);
  }
}

void BodyTouchSearch::place_corners(const BodyTouchQuery& q) {
  corners_.clear();
  corner_bounds_ = Box::nothing();
  for (size_t i = 0; i < bodies_.size(); ++i) {
    Moving& m = bodies_[i];
    m.corners = corners_.size();
    if (!q.bodies.form(i).solid) continue;
    for (const BodyCorner& corner : q.forms[q.form_of[i]].corners) {
      const Vec3 begin = m.begin.point(corner.at), end = m.end.point(corner.at);
      Box box{begin, begin};
      box.cover(end);
      corners_.push_back({begin, end, box.grown(kRoom * (q.reach + corner.radius))});
      corner_bounds_.cover(corners_.back().box.low), corner_bounds_.cover(corners_.back().box.high);
    }
  }
}

void BodyTouchSearch::place_edges(const BodyTouchQuery& q) {
  edges_.clear();
  for (size_t i = 0; i < bodies_.size(); ++i) {
    Moving& m = bodies_[i];
    m.edges = edges_.size();
    if (!q.bodies.form(i).solid) continue;
    for (const BodyEdge& e : q.forms[q.form_of[i]].edges) {
      Box box = Box::nothing();
      for (const Transform* at : {&m.begin, &m.end}) box.cover(at->point(e.from)), box.cover(at->point(e.to));
      edges_.push_back(box.grown(kRoom * (q.reach + e.radius)));
    }
  }
}

template <class Visit>
void BodyTouchSearch::near(const Box& box, Visit&& visit) const {
  for (const uint32_t body : unbounded_) visit(body);
  grid_.overlapping(box, visit);
}

std::optional<BodyTouch> BodyTouchSearch::touch(const BodyTouchQuery& q, uint32_t point,
                                                uint32_t body) const {
  const Moving& m = bodies_[body];
  const Solid& solid = *q.bodies.form(body).solid;
  const Vec3 x0 = load3(q.start.x(), point), x1 = q.points.place(point);
  const Vec3 p0 = m.begin.inverse_point(x0), p1 = m.end.inverse_point(x1);
  const double within = q.reach + std::max(q.reach, kNear);
  BodyTouch t;
  t.link.rows[0] = point, t.link.body = body, t.reach = q.reach;
  Vec3 n;  // in the body's frame
  const bool flat = q.forms[q.form_of[body]].in == BodyAccess::Space::plane;
  const auto found = [&](const Vec3& normal, const Vec3& place,
                         std::optional<double> s) -> std::optional<BodyTouch> {
    n = normal, t.place = place;
    if (flat) {
      // A prism does not end along z.
      n.z = 0;
      if (!(norm2(n) > 0.25)) return std::nullopt;
      n = normalized(n);
    }
    t.s = s.value_or(closes_at(dot(n, p0 - place) - q.reach, dot(n, p1 - place) - q.reach));
    t.n = m.end.direction(n);
    t.from = p0 + (p1 - p0) * t.s;
    return t;
  };
  const auto at_end = [&](const PointDistance& d) {
    return found(d.normal, p1 - d.normal * d.distance, std::nullopt);
  };
  const auto end = point_distance(solid, p1, within);
  const bool surface = is_surface(solid.kind);
  const double moved = norm(p1 - p0);
  if (solid.kind == SolidKind::plane || (!surface && moved <= kFar * q.forms[q.form_of[body]].inner)) {
    return end ? at_end(*end) : std::nullopt;
  }
  if (const auto start = point_distance(solid, p0, within)) {
    // A point touching from the start stays on its side; one that only comes near is searched along its path.
    const Vec3 place = p0 - start->normal * start->distance;
    const double ends = dot(start->normal, p1 - place) - q.reach;
    if ((surface || start->distance <= q.reach) && ends < 0) return found(start->normal, place, std::nullopt);
    if (surface || start->distance <= q.reach) return end ? at_end(*end) : std::nullopt;
  }
  Solid dot_solid;
  dot_solid.size = {};
  const Sweep way{{x0, {}}, x1 - x0, {}};
  if (const auto hit = time_of_impact(solid, m.sweep, dot_solid, way, std::max(q.reach, kTouch))) {
    const Transform then = m.sweep.at(hit->t);
    const Vec3 normal = then.inverse_direction(hit->normal);
    const Vec3 at = then.inverse_point(x0 + way.move * hit->t);
    return found(normal, at - normal * hit->gap, hit->t);
  }
  return end ? at_end(*end) : std::nullopt;
}

void BodyTouchSearch::look_at_point(const BodyTouchQuery& q, uint32_t point,
                                    std::vector<BodyTouch>& out) const {
  if (unbounded_.empty() && !grid_.bounds().overlaps(ways_[point])) return;
  near(ways_[point], [&](uint32_t body) {
    if (const auto t = touch(q, point, body)) out.push_back(*t);
  });
}

void BodyTouchSearch::look_at_hull(const BodyTouchQuery& q, uint32_t hull,
                                   std::vector<BodyTouch>& out) const {
  const SolidList::Corners c = q.hulls.corners(hull);
  // If all corners are beyond one side, so is everything between them.
  uint8_t all = sides_[c.rows[0]];
  for (size_t k = 1; k < c.count; ++k) all &= sides_[c.rows[k]];
  if (all != 0) return;
  Box box = ways_[c.rows[0]];
  for (size_t k = 1; k < c.count; ++k) box.cover(ways_[c.rows[k]]);
  near(box, [&](uint32_t body) {
    const Moving& m = bodies_[body];
    const std::vector<BodyCorner>& corners = q.forms[q.form_of[body]].corners;
    std::array<HullPath, 3> paths;
    std::array<Vec3, 3> end;
    for (size_t k = 0; k < c.count; ++k) {
      const Vec3 x = load3(q.start.x(), c.rows[k]);
      end[k] = q.points.place(c.rows[k]);
      paths[k] = {x, end[k] - x, {}};
    }
    for (size_t k = 0; k < corners.size(); ++k) {
      const BodyCorner& corner = corners[k];
      const auto& [y0, y1, room] = corners_[m.corners + k];
      // A line in space has no face that a corner could pass; a ball is wider than that.
      const bool flat = q.forms[q.form_of[body]].in == BodyAccess::Space::plane;
      if (!room.overlaps(box) || (c.count < 3 && corner.radius == 0 && !flat)) continue;
      const HullPath way{y0, y1 - y0, {}};
      const double reach = q.reach + corner.radius;
      if (c.count == 3 && stays_clear(way, paths, kRoom * reach)) continue;
      const auto hit = first_hull_contact(way, paths, c.count, reach);
      if (!hit) continue;
      // The place at the end, if that is on the same side.
      HullContact now = hull_distance(y1, end, c.count, -hit->n);
      if (!(now.apart > 0) || dot(now.n, hit->n) < 0.5) now = *hit;
      BodyTouch t;
      t.link = {c.rows, now.w, static_cast<uint32_t>(c.count), body};
      t.n = -now.n, t.reach = q.reach, t.s = hit->s;
      t.place = corner.at - m.end.inverse_direction(now.n) * corner.radius;
      const Vec3 touching = t.link.blend([&](size_t row) {
        const Vec3 x = load3(q.start.x(), row);
        return x + (q.points.place(row) - x) * hit->s;
      });
      t.from = m.sweep.at(hit->s).inverse_point(touching);
      out.push_back(t);
    }
  });
}

void BodyTouchSearch::look_at_edge(const BodyTouchQuery& q, const PointEdge& edge,
                                   std::vector<BodyTouch>& out) const {
  if (sides_[edge[0]] & sides_[edge[1]]) return;
  Box box = ways_[edge[0]];
  box.cover(ways_[edge[1]]);
  const MovingEdge points{load3(q.start.x(), edge[0]), load3(q.start.x(), edge[1]), q.points.place(edge[0]),
                          q.points.place(edge[1])};
  near(box, [&](uint32_t body) {
    const Moving& m = bodies_[body];
    const std::vector<BodyEdge>& edges = q.forms[q.form_of[body]].edges;
    for (size_t k = 0; k < edges.size(); ++k) {
      if (!edges_[m.edges + k].overlaps(box)) continue;
      const BodyEdge& e = edges[k];
      const auto meet = edges_meet(
          points, {m.begin.point(e.from), m.begin.point(e.to), m.end.point(e.from), m.end.point(e.to)},
          m.end.direction(e.outward), q.reach + e.radius, q.reach + e.radius + std::max(q.reach, kNear));
      if (!meet) continue;
      BodyTouch t;
      t.link = {{edge[0], edge[1], edge[1]}, {1 - meet->along, meet->along, 0}, 2, body};
      t.n = meet->n, t.reach = q.reach, t.s = meet->s;
      t.place = m.end.inverse_point(meet->place + meet->n * e.radius);
      const Vec3 touching = t.link.blend([&](size_t row) {
        const Vec3 x = load3(q.start.x(), row);
        return x + (q.points.place(row) - x) * meet->s;
      });
      t.from = m.sweep.at(meet->s).inverse_point(touching);
      out.push_back(t);
    }
  });
}

void find_edges(const PublishedSolids& hulls, std::vector<PointEdge>& out) {
  out.clear();
  out.reserve(3 * hulls.triangles.size() + hulls.segments.size());
  const auto add = [&](uint32_t a, uint32_t b) {
    if (a != b) out.push_back({std::min(a, b), std::max(a, b)});
  };
  for (const auto& t : hulls.triangles) add(t[0], t[1]), add(t[1], t[2]), add(t[2], t[0]);
  for (const auto& s : hulls.segments) add(s[0], s[1]);
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

const std::vector<BodyTouch>& BodyTouchSearch::run(const BodyTouchQuery& q, const ThreadArena& arena) {
  place_bodies(q);
  place_points(q);
  const size_t points = q.points.count, hulls = points + q.hulls.size(), all = hulls + q.edges.size();
  found_.resize((all + kBlock - 1) / kBlock);
  arena.for_blocks(all, kBlock, [&](size_t begin, size_t end) {
    std::vector<BodyTouch>& found = found_[begin / kBlock];
    found.clear();
    for (size_t i = begin; i < end; ++i) {
      if (i < points) {
        look_at_point(q, static_cast<uint32_t>(i), found);
      } else if (i < hulls) {
        look_at_hull(q, static_cast<uint32_t>(i - points), found);
      } else {
        look_at_edge(q, q.edges[i - hulls], found);
      }
    }
  });
  touches_.clear();
  for (const auto& found : found_) touches_.insert(touches_.end(), found.begin(), found.end());
  return touches_;
}

}  // namespace truestep::contact
