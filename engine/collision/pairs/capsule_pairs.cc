#include "engine/collision/pairs/capsule_pairs.h"

#include <cmath>

#include "engine/collision/pairs/distance/gjk.h"
#include "engine/collision/pairs/polyhedron.h"
#include "engine/collision/pairs/round_pairs.h"

namespace truestep {
namespace {

struct Axis {
  double separation = -std::numeric_limits<double>::infinity();
  Vec3 normal, on_a, on_b;
};

/// Axis of least overlap of a segment that enters the polyhedron.
Axis separating_axis(const Polyhedron& a, const Vec3& p, const Vec3& q) {
  Axis best;
  for (int f = 0; f < a.face_count; ++f) {
    const Vec3& n = a.faces[f].normal;
    const double sp = dot(n, p), sq = dot(n, q), s = (sp < sq ? sp : sq) - a.faces[f].offset;
    if (s > best.separation) best = {s, n, (sp < sq ? p : q) - n * s, sp < sq ? p : q};
  }
  const Vec3 d = q - p;
  for (int i = 0; i < a.edge_count; ++i) {
    const HullEdge& e = a.edges[i];
    const Vec3 &l = a.faces[e.left].normal, &r = a.faces[e.right].normal;
    if (dot(l, d) * dot(r, d) >= 0) continue;
    const Vec3 &from = a.vertices[e.from], along = a.vertices[e.to] - from, n = cross(along, d);
    const double n2 = norm2(n);
    if (!(n2 > 1e-14 * norm2(along) * norm2(d))) continue;
    const Vec3 unit = n / (dot(n, l + r) < 0 ? -std::sqrt(n2) : std::sqrt(n2));
    const double s = dot(unit, p - from);
    if (s > best.separation) {
      const SegmentPair at = nearest_on_segments(from, along, p, d);
      best = {s, unit, from + along * at.s, p + d * at.t};
    }
  }
  return best;
}

/// Cosines between the contact's normal and a face's from which a capsule lies on the face, and from which
/// one that leans over an edge of it is kept from falling onto it by the points of a lying one, while they
/// are within the margin. With the edge's point alone it gains some cm/s until both ends touch, and bodies
/// wedged with others rock between the two for ever.
constexpr double kLying = 1 - 1e-6, kLeaning = 0.98;

}  // namespace

void collide_capsule(const Convex& a, const Convex& b, const Transform& place, double margin, Manifold& out) {
  out.count = 0;
  const double r = b.size.x;
  const Vec3 h = axis(place.rotation, 1) * b.size.y, p = place.position - h, q = place.position + h;
  PolyhedronStorage storage;
  const Polyhedron poly = polyhedron(a, storage);
  if (poly.triangle && dot(poly.faces[0].normal, place.position) < poly.faces[0].offset) return;
  const CoreDistance d = core_distance(a, b, place, place.position - poly.center, margin + r);
  if (d.distance > margin + r) return;
  Axis at;
  if (d.verdict == CoreDistance::Verdict::separate && d.distance > 1e-9 * (r + b.size.y)) {
    at = {d.distance, d.normal, d.point_a, d.point_b};
  } else {
    at = separating_axis(poly, p, q);
  }
  // The direction belongs to a neighbour: only points over the triangle itself count.
  const bool own = !poly.triangle || poly.triangle->allows(at.normal);
  if (!own) {
    const Vec3& n = poly.faces[0].normal;
    const double sp = dot(n, p), sq = dot(n, q), s = (sp < sq ? sp : sq) - poly.faces[0].offset;
    at = {s, n, (sp < sq ? p : q) - n * s, sp < sq ? p : q};
  }

  const int face = face_towards(poly, at.normal);
  const Vec3& n = poly.faces[face].normal;
  const double facing = dot(n, at.normal);
  if (facing > (own ? kLeaning : kLying)) {
    const bool lies = facing > kLying;
    const Vec3 down = (lies ? n : at.normal) * r;
    FacePolygon reference, segment;
    face_polygon(poly, face, {}, reference);
    segment.add(p - down, 1);
    segment.add(q - down, 2);
    const uint32_t tag = static_cast<uint32_t>(face & 0xfff) + 1;
    if (lies) {
      clip_faces(reference, n, segment, margin, FaceOwner::first, tag, out);
    } else {
      clip_slanted(reference, n, at.normal, segment, margin, tag, out);
    }
    if (!own || (out.count > 0 && -out.deepest() <= at.separation - r + 1e-3 * r)) return;
    out.count = 0;
  }
  if (at.separation - r > margin) return;
  out.normal = at.normal;
  out.add((at.on_a + at.on_b - at.normal * r) * 0.5, at.separation - r, 0xc0000001u);
}

}  // namespace truestep
