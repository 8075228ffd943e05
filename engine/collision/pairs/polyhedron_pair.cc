#include "engine/collision/pairs/polyhedron_pair.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/pairs/distance/gjk.h"
#include "engine/collision/pairs/general_pair.h"
#include "engine/collision/pairs/polyhedron.h"

namespace truestep {
namespace {

constexpr double kLowest = -std::numeric_limits<double>::infinity();

struct FaceAxis {
  double separation = kLowest;
  int face = 0;
};
struct EdgeAxis {
  double separation = kLowest;
  Vec3 normal;
  int edge_a = 0, edge_b = 0;
};

double lowest_along(const Polyhedron& p, const Vec3& d) {
  double low = dot(p.vertices[0], d);
  for (int i = 1; i < p.vertex_count; ++i) low = std::min(low, dot(p.vertices[i], d));
  return low;
}

/// The face of p from which q, placed relative to p, is furthest; stops early beyond `enough`.
template <class Allowed>
FaceAxis face_axis(const Polyhedron& p, const Polyhedron& q, const Transform& q_in_p, double enough,
                   Allowed&& allowed, double& separation) {
  FaceAxis best;
  for (int f = 0; f < p.face_count; ++f) {
    const Vec3& n = p.faces[f].normal;
    const double s =
        lowest_along(q, q_in_p.inverse_direction(n)) + dot(n, q_in_p.position) - p.faces[f].offset;
    if (s > separation) separation = s;
    if (s > enough) return {s, f};
    if (s > best.separation && allowed(n)) best = {s, f};
  }
  return best;
}

/// Arcs (a, b) and (c, d) on the unit sphere cross; ba = b x a and dc = d x c up to positive factors.
bool arcs_cross(const Vec3& a, const Vec3& b, const Vec3& ba, const Vec3& c, const Vec3& d, const Vec3& dc) {
  const double cba = dot(c, ba), dba = dot(d, ba), adc = dot(a, dc), bdc = dot(b, dc);
  return cba * dba < 0 && adc * bdc < 0 && cba * bdc > 0;
}

template <class Allowed>
EdgeAxis edge_axis(const Polyhedron& a, const Polyhedron& b, const Transform& place, double enough,
                   Allowed&& allowed, double& separation) {
  EdgeAxis best;
  for (int j = 0; j < b.edge_count; ++j) {
    const HullEdge& eb = b.edges[j];
    const Vec3 pb = place.point(b.vertices[eb.from]);
    const Vec3 db = place.direction(b.vertices[eb.to] - b.vertices[eb.from]);
    const Vec3 c = -place.direction(b.faces[eb.left].normal), d = -place.direction(b.faces[eb.right].normal);
    for (int i = 0; i < a.edge_count; ++i) {
      const HullEdge& ea = a.edges[i];
      const Vec3 &na = a.faces[ea.left].normal, &nb = a.faces[ea.right].normal;
      const Vec3 da = a.vertices[ea.to] - a.vertices[ea.from];
      // Left and right of an edge: right x left points backwards along it.
      if (!arcs_cross(na, nb, -da, c, d, -db)) continue;
      const Vec3 n = cross(da, db);
      const double l2 = norm2(n);
      if (!(l2 > 1e-14 * norm2(da) * norm2(db))) continue;
      const double l = std::sqrt(l2);
      const Vec3 unit = dot(n, na + nb) < 0 ? n / -l : n / l;
      const double s = dot(unit, pb - a.vertices[ea.from]);
      if (s > separation) separation = s;
      if (s > enough) return {s, unit, i, j};
      if (s > best.separation && allowed(unit)) best = {s, unit, i, j};
    }
  }
  return best;
}

/// Nearest points of two lines p + s d, q + t e that are not parallel, clamped to the segments. Empty when
/// the edges are apart and pass each other by more than `slack`.
void edge_contact(const Vec3& p, const Vec3& d, const Vec3& q, const Vec3& e, const Vec3& normal, uint32_t id,
                  double slack, Manifold& out) {
  const Vec3 r = q - p;
  const double dd = norm2(d), ee = norm2(e), de = dot(d, e), det = dd * ee - de * de;
  double s = (dot(d, r) * ee - dot(e, r) * de) / det, t = (dot(d, r) * de - dot(e, r) * dd) / det;
  s = s < 0 ? 0 : s > 1 ? 1 : s;
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  const Vec3 x = p + d * s, y = q + e * t;
  out.normal = normal;
  out.count = 0;
  const double separation = dot(normal, y - x);
  if (separation > 0 && norm(y - x - normal * separation) > slack) return;
  out.add((x + y) * 0.5, separation, id);
}

/// For separated bodies, separating axes give only a lower bound. True when the points found prove it tight.
/// Points nearer than the bound are those of edges that pass each other: along an axis that a triangle's
/// neighbours leave to it.
bool tight(const Manifold& m, double bound, double slack) {
  return m.count > 0 && std::abs(m.deepest() + bound) <= slack;
}

}  // namespace

void collide_polyhedra(const Convex& ca, const Convex& cb, const Transform& place, double margin,
                       Manifold& out) {
  out.count = 0;
  PolyhedronStorage sa, sb;
  const Polyhedron a = polyhedron(ca, sa), b = polyhedron(cb, sb);
  // All pairs of edges of two large hulls cost more than a search (measured: equal near 600).
  if (a.edge_count * b.edge_count > 700) return collide_general(ca, cb, place, margin, out);
  const Transform back = inverse(place);
  const auto any = [](const Vec3&) { return true; };
  const auto towards_b = [&](const Vec3& n) { return !a.triangle || a.triangle->allows(n); };
  // A triangle does not push what is behind it.
  if (a.triangle && dot(a.faces[0].normal, place.point(b.center)) < a.faces[0].offset) return;

  double separation = kLowest;
  const FaceAxis fa = face_axis(a, b, place, margin, any, separation);
  if (separation > margin) return;
  const FaceAxis fb = face_axis(
      b, a, back, margin, [&](const Vec3& n) { return towards_b(-place.direction(n)); }, separation);
  if (separation > margin) return;
  const EdgeAxis edge = edge_axis(a, b, place, margin, towards_b, separation);
  if (separation > margin) return;

  // Faces make better manifolds than edges, and the choice should not alternate between a's and b's.
  const double bias = 1e-3 * std::min(a.thickness, b.thickness);
  const auto from_faces = [&](const FaceAxis& best, FaceOwner owner) {
    FacePolygon reference, incident;
    if (owner == FaceOwner::first) {
      const Vec3 n = a.faces[best.face].normal;
      face_polygon(a, best.face, {}, reference);
      const int other = furthest_face(b, place.inverse_direction(-n));
      face_polygon(b, other, place, incident);
      clip_faces(reference, n, incident, margin, owner,
                 static_cast<uint32_t>(best.face & 0xff) << 8 | (other & 0xff), out);
    } else {
      const Vec3 n = place.direction(b.faces[best.face].normal);
      face_polygon(b, best.face, place, reference);
      const int other = furthest_face(a, -n);
      face_polygon(a, other, {}, incident);
      clip_faces(reference, n, incident, margin, owner,
                 static_cast<uint32_t>(best.face & 0xff) << 8 | (other & 0xff), out);
      for (int i = 0; i < out.count; ++i) out.points[i].id ^= 0x80000000u;
    }
  };
  const double faces = std::max(fa.separation, fb.separation);
  if (edge.separation > faces + bias) {
    const HullEdge &ea = a.edges[edge.edge_a], &eb = b.edges[edge.edge_b];
    const Vec3 p = a.vertices[ea.from], q = place.point(b.vertices[eb.from]);
    edge_contact(p, a.vertices[ea.to] - p, q, place.point(b.vertices[eb.to]) - q, edge.normal,
                 0x40000000u | static_cast<uint32_t>(edge.edge_a & 0x7fff) << 15 | (edge.edge_b & 0x7fff),
                 bias, out);
  } else if (fb.separation > fa.separation + bias) {
    from_faces(fb, FaceOwner::second);
  } else {
    from_faces(fa, FaceOwner::first);
  }
  if (separation <= 0 ? out.count > 0 : tight(out, separation, bias)) return;

  // Corner against corner and similar: the exact nearest points, one contact.
  const CoreDistance d = core_distance(ca, cb, place, place.point(b.center) - a.center);
  if (d.verdict == CoreDistance::Verdict::separate && d.distance > 0) {
    out.count = 0;
    if (d.distance > margin || !towards_b(d.normal)) return;
    out.normal = d.normal;
    out.add((d.point_a + d.point_b) * 0.5, d.distance, 0xc0000000u);
  } else if (!a.triangle) {
    // For deep penetration, the faces of the best axis may not overlap.
    collide_general(ca, cb, place, margin, out);
  }
}

}  // namespace truestep
