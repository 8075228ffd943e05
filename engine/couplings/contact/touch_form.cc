#include "engine/couplings/contact/touch_form.h"

#include "engine/geometry/compound.h"
#include "engine/math/trig.h"

namespace truestep::contact {

namespace {

/// Corners on each rim of a cylinder.
constexpr int kRim = 8;

void add_corners(const Solid& s, const Transform& at, std::vector<BodyCorner>& out) {
  const auto add = [&](const Vec3& p, double radius) { out.push_back({at.point(p), radius}); };
  switch (s.kind) {
    case SolidKind::sphere:
      return add({}, s.size.x);
    case SolidKind::capsule:
      for (const double y : {-1.0, 0.0, 1.0}) add({0, y * s.size.y, 0}, s.size.x);
      return;
    case SolidKind::box:
      for (int k = 0; k < 8; ++k) {
        add({k & 1 ? s.size.x : -s.size.x, k & 2 ? s.size.y : -s.size.y, k & 4 ? s.size.z : -s.size.z}, 0);
      }
      return;
    case SolidKind::cylinder:
      for (int k = 0; k < kRim; ++k) {
        const auto [sin, cos] = trig::sincos(6.283185307179586 * k / kRim);
        for (const double y : {-s.size.y, s.size.y}) add({s.size.x * cos, y, s.size.x * sin}, 0);
      }
      return;
    case SolidKind::hull:
      for (const Vec3& v : s.hull->vertices) add(v, 0);
      return;
    case SolidKind::compound:
      for (const Compound::Part& part : s.compound->parts()) add_corners(part.solid, at * part.place, out);
      return;
    case SolidKind::triangle:
    case SolidKind::plane:
    case SolidKind::mesh:
    case SolidKind::height_field:
      return;
  }
}

/// Corners of prisms are edges along z, of which one point is enough in the plane; for capsules it is the
/// middle.
void flatten(TouchForm& form) {
  std::erase_if(form.corners, [](const BodyCorner& c) { return c.radius > 0 ? c.at.z != 0 : c.at.z < 0; });
  for (BodyCorner& c : form.corners) c.at.z = 0;
}

/// Straight edges of a convex polyhedron, convex as seen from outside.
void add_edges(const Hull& hull, const Transform& at, std::vector<BodyEdge>& out) {
  for (const HullEdge& e : hull.edges) {
    const Vec3 outward = hull.faces[e.left].normal + hull.faces[e.right].normal;
    out.push_back({at.point(hull.vertices[e.from]), at.point(hull.vertices[e.to]),
                   at.direction(normalized(outward, {0, 1, 0})), 0});
  }
}

void add_edges(const Vec3& half, const Transform& at, std::vector<BodyEdge>& out) {
  const double h[3] = {half.x, half.y, half.z};
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int k = 0; k < 4; ++k) {
      double from[3], to[3], out_of[3] = {0, 0, 0};
      from[u] = to[u] = k & 1 ? h[u] : -h[u], from[v] = to[v] = k & 2 ? h[v] : -h[v];
      from[axis] = -h[axis], to[axis] = h[axis];
      out_of[u] = k & 1 ? 1 : -1, out_of[v] = k & 2 ? 1 : -1;
      out.push_back(
          {at.point(load3(from, 0)), at.point(load3(to, 0)), at.direction(normalized(load3(out_of, 0))), 0});
    }
  }
}

void add_edges(const Solid& s, const Transform& at, std::vector<BodyEdge>& out) {
  switch (s.kind) {
    case SolidKind::capsule:
      return out.push_back({at.point({0, -s.size.y, 0}), at.point({0, s.size.y, 0}), {}, s.size.x});
    case SolidKind::box:
      return add_edges(s.size, at, out);
    case SolidKind::hull:
      return add_edges(*s.hull, at, out);
    case SolidKind::compound:
      for (const Compound::Part& part : s.compound->parts()) add_edges(part.solid, at * part.place, out);
      return;
    case SolidKind::sphere:
    case SolidKind::cylinder:
    case SolidKind::triangle:
    case SolidKind::plane:
    case SolidKind::mesh:
    case SolidKind::height_field:
      return;
  }
}

}  // namespace

TouchForm touch_form(const BodyForm& form, BodyAccess::Space space) {
  TouchForm out;
  out.in = space;
  if (!form.solid) return out;
  add_corners(*form.solid, {}, out.corners);
  if (space == BodyAccess::Space::plane) {
    flatten(out);
  } else {
    add_edges(*form.solid, {}, out.edges);
  }
  out.inner = inner_radius(*form.solid), out.reach = bounding_radius(*form.solid);
  return out;
}

}  // namespace truestep::contact
