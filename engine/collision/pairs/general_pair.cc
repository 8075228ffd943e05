#include "engine/collision/pairs/general_pair.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/pairs/distance/epa.h"
#include "engine/collision/pairs/polyhedron.h"
#include "engine/collision/pairs/round_pairs.h"

namespace truestep {
namespace {

/// The feature of a solid that faces a direction.
struct Feature {
  FacePolygon shape;  // face, line (2 corners) or nothing
  Vec3 normal;        // of a face
  double facing = 0;  // normal . direction; 0 when there is no face
  double radius = 0;  // of a line's rounding
  uint32_t number = 0;
};

/// Direction and result in the frame to which `at` transforms. Faces are returned at any angle, lines of
/// cylinders and capsules when the direction is nearly perpendicular to them. `beside`: frame of the other
/// solid, relative to which points on a rim are numbered: they stay in place while a cylinder spins about its
/// axis.
void feature(const Convex& c, const Transform& at, const Vec3& direction, const Rotation& beside,
             Feature& out) {
  const Vec3 d = at.inverse_direction(direction);
  out.shape.count = 0;
  switch (c.kind) {
    case SolidKind::box:
    case SolidKind::hull:
    case SolidKind::triangle: {
      PolyhedronStorage storage;
      const Polyhedron p = polyhedron(c, storage);
      const int f = furthest_face(p, d);
      face_polygon(p, f, at, out.shape);
      out.normal = at.direction(p.faces[f].normal);
      out.facing = dot(p.faces[f].normal, d);
      out.number = static_cast<uint32_t>(f);
      return;
    }
    case SolidKind::cylinder: {
      const double side = d.y < 0 ? -1 : 1, l = std::sqrt(d.x * d.x + d.z * d.z);
      const Vec3 u = l > 1e-12 ? Vec3{d.x / l, 0, d.z / l} : Vec3{1, 0, 0};
      if (std::fabs(d.y) < 0.3) {
        for (const double s : {-1.0, 1.0}) {
          out.shape.add(at.point({u.x * c.size.x, s * c.size.y, u.z * c.size.x}), s < 0 ? 1 : 2);
        }
        return;
      }
      // Sixteen points on the rim, the nearest of them moved to where it reaches furthest.
      static constexpr double kCos[16] = {1,  0.9238795325112867,  0.7071067811865476,  0.3826834323650898,
                                          0,  -0.3826834323650898, -0.7071067811865476, -0.9238795325112867,
                                          -1, -0.9238795325112867, -0.7071067811865476, -0.3826834323650898,
                                          0,  0.3826834323650898,  0.7071067811865476,  0.9238795325112867};
      const Vec3 own = axis(at.rotation, 1), x = axis(beside, 0);
      const Vec3 first = at.inverse_direction(std::fabs(dot(own, x)) < 0.7 ? x : axis(beside, 1));
      const Vec3 e = normalized(Vec3{first.x, 0, first.z}, {1, 0, 0});
      const auto place = [&](int k) {
        const double cos = kCos[k], sin = kCos[(k + 12) % 16];
        return Vec3{cos * e.x - sin * e.z, 0, cos * e.z + sin * e.x};
      };
      int nearest = 0;
      double most = -2;
      for (int k = 0; k < 16; ++k) {
        const double along = dot(place(k), u);
        if (along > most) most = along, nearest = k;
      }
      for (int i = 0; i < 16; ++i) {
        // Anticlockwise seen from outside.
        const int k = side > 0 ? (16 - i) % 16 : i;
        const Vec3 rim = (k == nearest && l > 1e-6 ? u : place(k)) * c.size.x;
        out.shape.add(at.point({rim.x, side * c.size.y, rim.z}), static_cast<uint32_t>(k));
      }
      out.normal = at.direction({0, side, 0});
      out.facing = side * d.y;
      out.number = side > 0 ? 1 : 2;
      return;
    }
    case SolidKind::capsule:
      out.radius = c.size.x;
      for (const double s : {-1.0, 1.0}) out.shape.add(at.point({0, s * c.size.y, 0}), s < 0 ? 1 : 2);
      return;
    case SolidKind::sphere:
    case SolidKind::plane:
    case SolidKind::mesh:
    case SolidKind::height_field:
    case SolidKind::compound:
      return;
  }
}

/// Candidate directions of faces that may separate a from b, in a's frame.
struct Guesses {
  int count = 0;
  Vec3 direction[24];
  void add(const Vec3& d) {
    if (count < 24) direction[count++] = d;
  }
};
void guess(const Convex& c, const Rotation& to_a, double sign, const Vec3& from_a, Guesses& out) {
  if (c.kind == SolidKind::cylinder) {
    const Vec3 along = axis(to_a, 1);
    out.add(along);
    out.add(-along);
    out.add(normalized(from_a - along * dot(along, from_a), axis(to_a, 0)));
  } else if (c.kind >= SolidKind::box && c.kind <= SolidKind::triangle) {
    PolyhedronStorage storage;
    const Polyhedron p = polyhedron(c, storage);
    for (int f = 0; f < p.face_count && f < 12; ++f) out.add(to_a.apply(p.faces[f].normal) * sign);
  }
}

/// Contact over a face of either; empty when neither faces along n.
void face_contact(const Feature& fa, const Feature& fb, const Vec3& n, double margin, double aligned,
                  Manifold& out) {
  out.count = 0;
  // Faces within 1.4 mrad of one another face equally well: a body at rest must not switch between them by
  // rounding.
  constexpr double kEqual = 1e-6;
  const bool first = fa.facing >= fb.facing - kEqual;
  const Feature &reference = first ? fa : fb, &other = first ? fb : fa;
  if (reference.facing < aligned || other.shape.count == 0) return;
  Feature incident = other;
  const Vec3 down = reference.normal * other.radius;
  for (int i = 0; i < incident.shape.count; ++i) incident.shape.corner[i] -= down;
  clip_faces(reference.shape, reference.normal, incident.shape, margin,
             first ? FaceOwner::first : FaceOwner::second,
             (reference.number & 0xff) << 8 | (incident.number & 0x7f) << 1 | (first ? 0u : 1u), out);
}

}  // namespace

void collide_general(const Convex& a, const Convex& b, const Transform& place, double margin, Manifold& out) {
  out.count = 0;
  const double ra = a.radius(), rb = b.radius(), r = ra + rb;
  const Vec3 ca = a.center(), cb = place.point(b.center());
  if (a.triangle && dot(a.triangle->normal, cb - a.triangle->corner[0]) < 0) return;
  const CoreDistance d = core_distance(a, b, place, cb - ca, margin + r);
  if (d.distance > margin + r) return;
  Vec3 n = d.normal, pa = d.point_a, pb = d.point_b;
  double separation = d.distance;
  const double size = std::min(a.extent(), b.extent());
  const bool overlap = d.verdict == CoreDistance::Verdict::overlap || d.distance <= 1e-9 * size;
  CoreDepth depth;
  if (overlap) {
    Guesses guesses;
    guess(a, {}, 1, cb - ca, guesses);
    guess(b, place.rotation, -1, cb - ca, guesses);
    depth = core_depth(a, b, place, d.simplex, {guesses.direction, static_cast<size_t>(guesses.count)});
    if (depth.source == CoreDepth::Source::search) refine(a, b, place, size, depth);
    n = depth.normal, separation = -depth.depth;
  }
  const bool own = !a.triangle || a.triangle->allows(n);
  if (!own) n = a.triangle->normal;

  Feature fa, fb;
  feature(a, {}, n, place.rotation, fa);
  feature(b, place, -n, {}, fb);
  const double slack = 1e-3 * size;
  face_contact(fa, fb, n, margin, 1 - 1e-5, out);
  if (!own || (out.count > 0 && -out.deepest() <= separation - r + slack)) return;
  out.count = 0;
  out.normal = n;
  if (fa.shape.count == 2 && fb.shape.count == 2) {
    const Vec3 p[2] = {fa.shape.corner[0], fa.shape.corner[1]},
               q[2] = {fb.shape.corner[0], fb.shape.corner[1]};
    line_contact(p, fa.radius, q, fb.radius, n, margin, out);
    if (out.count > 0 && -out.deepest() <= separation - r + slack) return;
    out.count = 0;
  }
  if (overlap) {
    if (depth.source == CoreDepth::Source::guess) refine(a, b, place, size, depth);
    out.normal = n = depth.normal, pa = depth.point_a, pb = depth.point_b, separation = -depth.depth;
  }
  out.add((pa + n * ra + pb - n * rb) * 0.5, separation - r, 0xc0000002u);
}

}  // namespace truestep
