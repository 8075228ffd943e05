#include "engine/couplings/contact/edge_touch.h"

#include "engine/kernels/contact/edge_edge.h"

namespace truestep::contact {

std::optional<EdgeMeeting> edges_meet(const MovingEdge& points, const MovingEdge& body, const Vec3& outward,
                                      double reach, double within) {
  const auto end = nearest_inside(points.from1, points.to1, body.from1, body.to1);
  if (!end) return std::nullopt;
  const auto start = nearest_inside(points.from0, points.to0, body.from0, body.to0);
  const bool outside = outward == Vec3{};
  if (start && !outside && !(dot(start->apart, outward) > 0)) return std::nullopt;
  // A line that was on the other side of the body's edge has passed it.
  Vec3 n = normalized(end->apart, start ? normalized(start->apart) : outward);
  double before = reach, after = norm(end->apart);
  if (start) {
    if (dot(n, start->apart) < 0) n = -n, after = -after;
    before = dot(n, start->apart);
  } else if (!outside && !(dot(n, outward) > 0)) {
    return std::nullopt;
  }
  if (!(norm2(n) > 0) || after > within) return std::nullopt;
  EdgeMeeting m;
  m.along = end->a, m.n = n;
  m.place = body.from1 + (body.to1 - body.from1) * end->b;
  m.s = before <= reach ? 0 : after < reach ? (before - reach) / (before - after) : 1;
  return m;
}

}  // namespace truestep::contact
