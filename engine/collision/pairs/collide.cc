#include "engine/collision/pairs/collide.h"

#include "engine/collision/pairs/box_box.h"
#include "engine/collision/pairs/capsule_pairs.h"
#include "engine/collision/pairs/general_pair.h"
#include "engine/collision/pairs/merge_manifolds.h"
#include "engine/collision/pairs/plane_pairs.h"
#include "engine/collision/pairs/polyhedron_pair.h"
#include "engine/collision/pairs/round_pairs.h"
#include "engine/geometry/compound.h"
#include "engine/geometry/height_field.h"

namespace truestep {
namespace {

void to_world(const Transform& at, Manifold& m) {
  m.normal = at.direction(m.normal);
  for (int i = 0; i < m.count; ++i) m.points[i].position = at.point(m.points[i].position);
}

/// Both convex, or one a plane.
bool collide_pair(const Convex& a, const Transform& at_a, const Convex& b, const Transform& at_b,
                  double margin, Manifold& out) {
  if (a.kind >= b.kind) {
    collide_local(a, b, relative(at_a, at_b), margin, out);
    if (out.count == 0) return false;
    to_world(at_a, out);
  } else {
    collide_local(b, a, relative(at_b, at_a), margin, out);
    if (out.count == 0) return false;
    to_world(at_b, out);
    out.normal = -out.normal;
  }
  return true;
}

/// visit(Convex, Transform, part) for every convex part of `s` that may reach the box.
template <class Visit>
void each_part(const Solid& s, const Transform& at, const Box& reach, Visit&& visit) {
  if (s.kind != SolidKind::compound) return visit(view(s), at, 0u);
  const Transform back = inverse(at);
  const Vec3 half = (reach.high - reach.low) * 0.5, c = back.point(reach.center());
  const auto along = [&](const Vec3& row) {
    return std::fabs(row.x) * half.x + std::fabs(row.y) * half.y + std::fabs(row.z) * half.z;
  };
  const Vec3 e{along(back.rotation.row[0]), along(back.rotation.row[1]), along(back.rotation.row[2])};
  const bool finite = reach.finite();
  s.compound->tree().each(
      [&](const Box& b) {
        return !finite || b.overlaps({c - e, c + e});
      },
      [&](uint32_t i) {
        const auto& part = s.compound->parts()[i];
        visit(view(part.solid), at * part.place, i);
      });
}

/// visit(triangle, index) for triangles of a mesh or height field near a box in its frame.
template <class Visit>
void each_triangle(const Solid& s, const Box& near, Visit&& visit) {
  if (s.kind == SolidKind::mesh) {
    s.mesh->tree().overlapping(near, [&](uint32_t i) { visit(s.mesh->triangle(i), i); });
  } else {
    s.heights->overlapping(near, [&](uint32_t i) {
      if (const auto t = s.heights->triangle(i)) visit(*t, i);
    });
  }
}

bool is_surface(SolidKind k) {
  return k == SolidKind::mesh || k == SolidKind::height_field;
}

size_t collide_surface(const Solid& surface, const Transform& at, const Solid& body, const Transform& at_body,
                       double margin, std::vector<Manifold>& out) {
  const size_t before = out.size();
  each_part(body, at_body, bounds(surface, at).grown(margin),
            [&](const Convex& b, const Transform& at_b, uint32_t part) {
              const Transform place = relative(at, at_b);
              const Box box =
                  bounds(body.kind == SolidKind::compound ? body.compound->parts()[part].solid : body, place);
              each_triangle(surface, box.grown(margin), [&](const MeshTriangle& t, uint32_t index) {
                Manifold m;
                collide_local(view(t), b, place, margin, m);
                if (m.count == 0) return;
                to_world(at, m);
                m.part_a = index, m.part_b = part;
                for (int i = 0; i < m.count; ++i) m.points[i].id = mixed_id(m.points[i].id, index, part);
                merge_manifold(m, before, 1e-5 * norm(box.high - box.low), out);
              });
            });
  return out.size() - before;
}

size_t collide_plane_and_mesh(const Solid& plane, const Transform& at, const Solid& mesh,
                              const Transform& at_mesh, double margin, std::vector<Manifold>& out) {
  Manifold m;
  collide_plane_mesh(plane.size, *mesh.mesh, relative(at, at_mesh), margin, m);
  if (m.count == 0) return 0;
  to_world(at, m);
  out.push_back(m);
  return 1;
}

}  // namespace

void collide_local(const Convex& a, const Convex& b, const Transform& place, double margin, Manifold& out) {
  if (a.kind == SolidKind::plane) return collide_plane(a.size, b, place, margin, out);
  if (b.kind == SolidKind::sphere) return collide_sphere(a, b.size.x, place.position, margin, out);
  if (a.kind == SolidKind::cylinder || b.kind == SolidKind::cylinder) {
    return collide_general(a, b, place, margin, out);
  }
  if (b.kind == SolidKind::capsule) {
    return a.kind == SolidKind::capsule ? collide_capsules(a, b, place, margin, out)
                                        : collide_capsule(a, b, place, margin, out);
  }
  if (a.kind == SolidKind::box) return collide_boxes(a.size, b.size, place, margin, out);
  collide_polyhedra(a, b, place, margin, out);
}

bool collide(const Solid& a, const Transform& at_a, const Solid& b, const Transform& at_b, double margin,
             Manifold& out) {
  out.part_a = out.part_b = 0;
  out.count = 0;
  const bool known = (is_convex(a.kind) && (is_convex(b.kind) || b.kind == SolidKind::plane)) ||
                     (a.kind == SolidKind::plane && is_convex(b.kind));
  return known && collide_pair(view(a), at_a, view(b), at_b, margin, out);
}

size_t collide(const Solid& a, const Transform& at_a, const Solid& b, const Transform& at_b, double margin,
               std::vector<Manifold>& out) {
  const bool fixed_a = is_surface(a.kind) || a.kind == SolidKind::plane,
             fixed_b = is_surface(b.kind) || b.kind == SolidKind::plane;
  if (a.kind == SolidKind::plane && b.kind == SolidKind::mesh)
    return collide_plane_and_mesh(a, at_a, b, at_b, margin, out);
  if (a.kind == SolidKind::mesh && b.kind == SolidKind::plane) {
    const size_t count = collide_plane_and_mesh(b, at_b, a, at_a, margin, out);
    if (count > 0) out.back().normal = -out.back().normal;
    return count;
  }
  if (fixed_a && fixed_b) return 0;
  const size_t before = out.size();
  if (is_surface(a.kind)) return collide_surface(a, at_a, b, at_b, margin, out);
  if (is_surface(b.kind)) {
    collide_surface(b, at_b, a, at_a, margin, out);
    for (size_t i = before; i < out.size(); ++i) {
      out[i].normal = -out[i].normal;
      std::swap(out[i].part_a, out[i].part_b);
    }
    return out.size() - before;
  }
  each_part(a, at_a, bounds(b, at_b).grown(margin), [&](const Convex& ca, const Transform& ta, uint32_t ia) {
    const Box near = a.kind == SolidKind::compound && b.kind == SolidKind::compound
                         ? bounds(a.compound->parts()[ia].solid, ta).grown(margin)
                         : bounds(a, at_a).grown(margin);
    each_part(b, at_b, near, [&](const Convex& cb, const Transform& tb, uint32_t ib) {
      Manifold m;
      if (!collide_pair(ca, ta, cb, tb, margin, m)) return;
      m.part_a = ia, m.part_b = ib;
      for (int i = 0; i < m.count; ++i) m.points[i].id = mixed_id(m.points[i].id, ia, ib);
      out.push_back(m);
    });
  });
  return out.size() - before;
}

}  // namespace truestep
