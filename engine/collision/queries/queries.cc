#include "engine/collision/queries/queries.h"

#include "engine/collision/pairs/collide.h"
#include "engine/collision/pairs/distance/gjk.h"

namespace truestep {
namespace {

NearestPoints of_point(const Manifold& m) {
  int k = 0;
  for (int i = 1; i < m.count; ++i) {
    if (m.points[i].separation < m.points[k].separation) k = i;
  }
  const ContactPoint& p = m.points[k];
  const Vec3 half = m.normal * (0.5 * p.separation);
  return {p.separation, p.position - half, p.position + half, m.normal};
}

}  // namespace

std::optional<NearestPoints> nearest_points(const Solid& a, const Transform& at_a, const Solid& b,
                                            const Transform& at_b, double within) {
  if (is_convex(a.kind) && is_convex(b.kind)) {
    // For separated solids the distance search is exact; manifolds slightly prefer faces.
    const Convex ca = view(a), cb = view(b);
    const double ra = ca.radius(), rb = cb.radius();
    const CoreDistance d = core_distance(ca, cb, relative(at_a, at_b),
                                         at_a.inverse_point(at_b.position) - ca.center(), within + ra + rb);
    if (d.distance > within + ra + rb) return std::nullopt;
    if (d.distance > 0) {
      const Vec3 n = at_a.direction(d.normal);
      return NearestPoints{d.distance - ra - rb, at_a.point(d.point_a) + n * ra,
                           at_a.point(d.point_b) - n * rb, n};
    }
  }
  std::vector<Manifold> all;
  collide(a, at_a, b, at_b, within, all);
  std::optional<NearestPoints> best;
  for (const Manifold& m : all) {
    const NearestPoints p = of_point(m);
    if (!best || p.distance < best->distance) best = p;
  }
  return best;
}

std::optional<NearestPoint> nearest_point(const Solid& solid, const Transform& at, const Vec3& point,
                                          double within) {
  // A ball of zero size.
  Solid dot_solid;
  dot_solid.size = {};
  std::vector<Manifold> all;
  collide(solid, at, dot_solid, {{}, point}, within, all);
  std::optional<NearestPoint> best;
  for (const Manifold& m : all) {
    const NearestPoints p = of_point(m);
    if (!best || p.distance < best->distance) best = NearestPoint{p.distance, p.point_a, p.normal};
  }
  return best;
}

bool overlap(const Solid& a, const Transform& at_a, const Solid& b, const Transform& at_b) {
  const auto p = nearest_points(a, at_a, b, at_b, 0);
  return p && p->distance <= 0;
}

std::optional<Impact> shape_cast(const Solid& moving, const Pose& from, const Vec3& move, const Solid& target,
                                 const Pose& at, double touch) {
  return time_of_impact(moving, {from, move, {}}, target, resting(at), touch);
}

bool ray_meets(const FloatBox& b, const Ray& r, double most) {
  double enter = 0, leave = most;
  const double o[3] = {r.origin.x, r.origin.y, r.origin.z},
               d[3] = {r.direction.x, r.direction.y, r.direction.z};
  for (int k = 0; k < 3; ++k) {
    if (d[k] == 0) {
      if (o[k] < b.low[k] || o[k] > b.high[k]) return false;
      continue;
    }
    const double t0 = (b.low[k] - o[k]) / d[k], t1 = (b.high[k] - o[k]) / d[k];
    enter = t0 < t1 ? (t0 > enter ? t0 : enter) : (t1 > enter ? t1 : enter);
    leave = t0 < t1 ? (t1 < leave ? t1 : leave) : (t0 < leave ? t0 : leave);
  }
  return enter <= leave;
}

}  // namespace truestep
