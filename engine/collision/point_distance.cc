#include "engine/collision/point_distance.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/pairs/distance/gjk.h"
#include "engine/geometry/compound.h"
#include "engine/geometry/height_field.h"
#include "engine/geometry/shape_distance.h"
#include "engine/geometry/triangle_mesh.h"
#include "engine/kernels/contact/point_hull.h"

namespace truestep {
namespace {

PointDistance of(const SurfaceDistance<double>& s) {
  return {s.d, s.n};
}

PointDistance cylinder_distance(const Vec3& p, double r, double half) {
  const double l = std::sqrt(p.x * p.x + p.z * p.z);
  const Vec3 side = l > 0 ? Vec3{p.x / l, 0, p.z / l} : Vec3{1, 0, 0}, end{0, p.y < 0 ? -1.0 : 1.0, 0};
  const double out = l - r, over = std::fabs(p.y) - half;
  if (out <= 0 && over <= 0) return out > over ? PointDistance{out, side} : PointDistance{over, end};
  const double a = std::max(out, 0.0), b = std::max(over, 0.0), d = std::sqrt(a * a + b * b);
  return {d, (side * a + end * b) / d};
}

// Inside, the distance to the plane of the nearest face; outside, that between two convex sets, one of them a
// point.
std::optional<PointDistance> hull_distance_of(const Solid& s, const Vec3& p, double within) {
  PointDistance best{-HUGE_VAL, {0, 1, 0}};
  for (const HullFace& f : s.hull->faces) {
    const double d = dot(f.normal, p) - f.offset;
    if (d > best.distance) best = {d, f.normal};
  }
  if (best.distance > within) return std::nullopt;
  if (best.distance <= 0) return best;
  Convex point;
  point.size = {};
  const CoreDistance d = core_distance(view(s), point, {{}, p}, p - s.hull->center);
  if (!(d.distance > 0)) return best;
  if (d.distance > within) return std::nullopt;
  return PointDistance{d.distance, d.normal};
}

void of_triangle(const MeshTriangle& t, const Vec3& p, double within, std::optional<PointDistance>& best) {
  const std::array<Vec3, 3> c{t.corner[0], t.corner[1], t.corner[2]};
  if (dot(t.normal, p - c[0]) < 0) return;
  const Vec3 r = p - blend(c, nearest_on_hull(p, c, 3), 3);
  const double d = norm(r);
  if (d <= within && (!best || d < best->distance)) best = {d, d > 0 ? r / d : t.normal};
}

/// The nearest of the triangles that enclose a volume. Where several are equally near, the nearest point is
/// on an edge or a corner, and the triangle whose plane is farthest from the point (on either side) decides
/// the sign.
struct Enclosing {
  double distance = HUGE_VAL, height = 0;
  Vec3 way;  ///< unit, from the nearest point of the surface

  void take(const MeshTriangle& t, const Vec3& p) {
    constexpr double kEqual = 1e-9;
    const std::array<Vec3, 3> c{t.corner[0], t.corner[1], t.corner[2]};
    const Vec3 r = p - blend(c, nearest_on_hull(p, c, 3), 3);
    const double d = norm(r), over = dot(t.normal, p - c[0]);
    const double margin = kEqual * (d + distance);
    if (d > distance + margin || (d >= distance - margin && std::fabs(over) <= std::fabs(height))) return;
    distance = std::min(d, distance), height = over, way = d > 0 ? r / d : t.normal;
    if (height < 0) way = -way;
  }
};

}  // namespace

MeshSides mesh_sides(const Solid& s) {
  return s.kind == SolidKind::mesh && !s.mesh->closed() ? MeshSides::front : MeshSides::enclosed;
}

std::optional<PointDistance> point_distance(const Solid& s, const Vec3& p, double within, MeshSides sides) {
  const auto near = [&](const PointDistance& d) {
    return d.distance <= within ? std::optional(d) : std::nullopt;
  };
  std::optional<PointDistance> best;
  const Box box = Box{p, p}.grown(within);
  switch (s.kind) {
    case SolidKind::sphere:
      return near(of(sphere_distance(p, s.size.x)));
    case SolidKind::capsule:
      return near(of(capsule_distance(p, s.size.x, s.size.y)));
    case SolidKind::box:
      return near(of(box_distance(p, s.size)));
    case SolidKind::plane:
      return near(of(plane_distance(p, s.size)));
    case SolidKind::cylinder:
      return near(cylinder_distance(p, s.size.x, s.size.y));
    case SolidKind::hull:
      return hull_distance_of(s, p, within);
    case SolidKind::compound:
      s.compound->tree().overlapping(box, [&](uint32_t i) {
        const Compound::Part& part = s.compound->parts()[i];
        const auto d = point_distance(part.solid, part.place.inverse_point(p), within);
        if (d && (!best || d->distance < best->distance)) {
          best = {d->distance, part.place.direction(d->normal)};
        }
      });
      return best;
    case SolidKind::mesh:
      if (sides == MeshSides::enclosed) {
        Enclosing found;
        s.mesh->tree().overlapping(box, [&](uint32_t i) { found.take(s.mesh->triangle(i), p); });
        if (!(found.distance <= within)) return std::nullopt;
        return PointDistance{std::copysign(found.distance, found.height), found.way};
      }
      s.mesh->tree().overlapping(box, [&](uint32_t i) { of_triangle(s.mesh->triangle(i), p, within, best); });
      return best;
    case SolidKind::height_field:
      s.heights->overlapping(box, [&](uint32_t i) {
        if (const auto t = s.heights->triangle(i)) of_triangle(*t, p, within, best);
      });
      return best;
    case SolidKind::triangle:
      break;
  }
  return best;
}

}  // namespace truestep
