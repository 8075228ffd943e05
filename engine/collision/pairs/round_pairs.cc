#include "engine/collision/pairs/round_pairs.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/pairs/distance/gjk.h"
#include "engine/collision/pairs/polyhedron.h"
#include "engine/kernels/contact/point_hull.h"

namespace truestep {
namespace {

/// A ball against a surface whose nearest point is `on`, unit normal n, with its centre `distance` above.
void touch(const Vec3& on, const Vec3& n, double distance, double r, double margin, Manifold& out) {
  out.count = 0;
  const double s = distance - r;
  if (s > margin) return;
  out.normal = n;
  out.add(on + n * (0.5 * s), s, 1);
}

/// `square`: the normal when the centre lies on the core.
void from_core_point(const Vec3& core, const Vec3& square, double ra, double r, const Vec3& center,
                     double margin, Manifold& out) {
  const Vec3 d = center - core;
  const double l = norm(d);
  const Vec3 n = l > 1e-12 * r ? d / l : square;
  touch(core + n * ra, n, l - ra, r, margin, out);
}

void on_box(const Vec3& half, double r, const Vec3& c, double margin, Manifold& out) {
  const SurfaceDistance<double> d = box_distance(c, half);
  touch(c - d.n * d.d, d.n, d.d, r, margin, out);
}

void on_cylinder(double radius, double half, double r, const Vec3& c, double margin, Manifold& out) {
  const double l = std::sqrt(c.x * c.x + c.z * c.z), side = c.y < 0 ? -1 : 1;
  const Vec3 radial = l > 0 ? Vec3{c.x / l, 0, c.z / l} : Vec3{1, 0, 0};
  const double beyond = l - radius, above = std::fabs(c.y) - half;
  if (beyond > 0 && above > 0) {  // nearest to the rim
    const Vec3 on{radial.x * radius, side * half, radial.z * radius}, d = c - on;
    const double s = norm(d);
    touch(on, d / s, s, r, margin, out);
  } else if (beyond > above) {
    touch({radial.x * radius, c.y, radial.z * radius}, radial, beyond, r, margin, out);
  } else {
    touch({c.x, side * half, c.z}, {0, side, 0}, above, r, margin, out);
  }
}

void on_hull(const Convex& a, double r, const Vec3& c, double margin, Manifold& out) {
  const Hull& h = *a.hull;
  double most = -std::numeric_limits<double>::infinity();
  const HullFace* face = nullptr;
  for (const HullFace& f : h.faces) {
    if (const double s = dot(f.normal, c) - f.offset; s > most) most = s, face = &f;
  }
  out.count = 0;
  if (most - r > margin) return;
  // Over the face itself its plane decides, as for a centre inside.
  bool over = true;
  for (uint32_t k = 0; k < face->count && most > 0 && over; ++k) {
    const Vec3 &p = h.vertices[h.loops[face->first + k]],
               &q = h.vertices[h.loops[face->first + (k + 1) % face->count]];
    over = dot(cross(q - p, face->normal), c - p) <= 0;
  }
  if (over) return touch(c - face->normal * most, face->normal, most, r, margin, out);
  const CoreDistance d = core_distance(a, Convex{SolidKind::sphere, {r, 0, 0}}, {{}, c}, c - h.center);
  if (!(d.distance > 0)) return touch(c - face->normal * most, face->normal, most, r, margin, out);
  touch(d.point_a, d.normal, d.distance, r, margin, out);
}

void on_triangle(const MeshTriangle& t, double r, const Vec3& c, double margin, Manifold& out) {
  out.count = 0;
  const double above = dot(t.normal, c - t.corner[0]);
  if (above < 0 || above - r > margin) return;
  const HullWeights w = nearest_on_triangle(c, t.corner[0], t.corner[1], t.corner[2]);
  const Vec3 on = t.corner[0] * w[0] + t.corner[1] * w[1] + t.corner[2] * w[2], d = c - on;
  const double l = norm(d);
  const Vec3 n = l > 0 && (w[0] == 0 || w[1] == 0 || w[2] == 0) ? d / l : t.normal;
  // The direction belongs to a neighbour: that triangle is nearer and handles it.
  if (!t.allows(n)) return;
  touch(on, n, l, r, margin, out);
}

}  // namespace

void collide_spheres(double ra, double rb, const Vec3& center, double margin, Manifold& out) {
  from_core_point({}, {0, 1, 0}, ra, rb, center, margin, out);
}

void collide_sphere(const Convex& a, double r, const Vec3& c, double margin, Manifold& out) {
  switch (a.kind) {
    case SolidKind::sphere:
      return from_core_point({}, {0, 1, 0}, a.size.x, r, c, margin, out);
    case SolidKind::capsule:
      return from_core_point({0, std::clamp(c.y, -a.size.y, a.size.y), 0}, {1, 0, 0}, a.size.x, r, c, margin,
                             out);
    case SolidKind::box:
      return on_box(a.size, r, c, margin, out);
    case SolidKind::cylinder:
      return on_cylinder(a.size.x, a.size.y, r, c, margin, out);
    case SolidKind::hull:
      return on_hull(a, r, c, margin, out);
    case SolidKind::triangle:
      return on_triangle(*a.triangle, r, c, margin, out);
    case SolidKind::plane:
    case SolidKind::mesh:
    case SolidKind::height_field:
    case SolidKind::compound:
      break;
  }
  out.count = 0;
}

SegmentPair nearest_on_segments(const Vec3& p, const Vec3& d, const Vec3& q, const Vec3& e) {
  const Vec3 r = p - q;
  const double a = norm2(d), b = dot(d, e), c = norm2(e), f = dot(d, r), g = dot(e, r), det = a * c - b * b;
  // Parallel: any s is valid where both overlap; the middle of p's segment is the most stable.
  double s = det > 1e-14 * a * c ? std::clamp((b * g - c * f) / det, 0.0, 1.0) : 0.5;
  double t = c > 0 ? (b * s + g) / c : 0;
  if (t < 0 || t > 1) {
    t = t < 0 ? 0 : 1;
    s = a > 0 ? std::clamp((b * t - f) / a, 0.0, 1.0) : 0;
  }
  return {s, t};
}

void line_contact(const Vec3 (&p)[2], double ra, const Vec3 (&q)[2], double rb, const Vec3& n, double margin,
                  Manifold& out) {
  const Vec3 d = p[1] - p[0];
  const double length = norm(d);
  const Vec3 u = d / length, e = q[1] - q[0];
  if (norm(cross(u, e)) > 0.05 * norm(e)) return;
  const double t0 = dot(u, q[0] - p[0]), t1 = dot(u, q[1] - p[0]);
  const double low = std::max(0.0, std::min(t0, t1)), high = std::min(length, std::max(t0, t1));
  if (!(high > low + 1e-6 * length)) return;
  uint32_t id = 2;
  for (const double t : {low, high}) {
    const Vec3 x = p[0] + u * t, y = q[0] + e * ((t - t0) / (t1 - t0));
    const double s = dot(n, y - x) - ra - rb;
    if (s <= margin) out.add((x + n * ra + y - n * rb) * 0.5, s, id);
    ++id;
  }
}

void collide_capsules(const Convex& a, const Convex& b, const Transform& place, double margin,
                      Manifold& out) {
  out.count = 0;
  const Vec3 p[2] = {{0, -a.size.y, 0}, {0, a.size.y, 0}};
  const Vec3 h = axis(place.rotation, 1) * b.size.y, q[2] = {place.position - h, place.position + h};
  const Vec3 d = p[1] - p[0], e = q[1] - q[0];
  const SegmentPair at = nearest_on_segments(p[0], d, q[0], e);
  const Vec3 x = p[0] + d * at.s, y = q[0] + e * at.t, gap = y - x;
  const double l = norm(gap), s = l - a.size.x - b.size.x;
  if (s > margin) return;
  // Crossing axes: separated along the direction perpendicular to both.
  Vec3 n;
  if (l > 1e-12 * (a.size.y + b.size.y)) {
    n = gap / l;
  } else {
    n = normalized(cross(d, e), {1, 0, 0});
    if (dot(n, place.position) < 0) n = -n;
  }
  out.normal = n;
  if (l > 0) line_contact(p, a.size.x, q, b.size.x, n, margin, out);
  // The deepest point must be among the line's ends.
  if (out.count > 0 && -out.deepest() <= s + 1e-3 * (a.size.x + b.size.x)) return;
  out.count = 0;
  out.add((x + n * a.size.x + y - n * b.size.x) * 0.5, s, 1);
}

}  // namespace truestep
