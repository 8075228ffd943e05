// Overlap and depth of convex solids compared with libccd's GJK + EPA, which sees them only through support
// functions of our test rig. libccd's depth is that of the one direction it finds.
#include <ccd/ccd.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"
#include "engine/collision/collision.h"

namespace truestep {
namespace {

struct Object {
  Solid solid;
  Transform at;
};

Vec3 furthest(const Solid& s, const Vec3& d) {
  const auto sign = [](double x) { return x < 0 ? -1.0 : 1.0; };
  const Vec3& e = s.size;
  switch (s.kind) {
    case SolidKind::sphere:
      return normalized(d) * e.x;
    case SolidKind::capsule:
      return normalized(d) * e.x + Vec3{0, sign(d.y) * e.y, 0};
    case SolidKind::cylinder:
      return normalized(Vec3{d.x, 0, d.z}) * e.x + Vec3{0, sign(d.y) * e.y, 0};
    case SolidKind::hull: {
      Vec3 best = s.hull->vertices[0];
      for (const Vec3& v : s.hull->vertices) best = dot(v, d) > dot(best, d) ? v : best;
      return best;
    }
    default:
      return {sign(d.x) * e.x, sign(d.y) * e.y, sign(d.z) * e.z};
  }
}

void support(const void* object, const ccd_vec3_t* d, ccd_vec3_t* out) {
  const auto& o = *static_cast<const Object*>(object);
  const Vec3 p = o.at.point(furthest(o.solid, o.at.inverse_direction({d->v[0], d->v[1], d->v[2]})));
  ccdVec3Set(out, p.x, p.y, p.z);
}

std::vector<Solid> solids() {
  std::vector<Vec3> points;
  for (uint64_t i = 0; i < 20; ++i) {
    const auto u = uniform4(5, 3, i);
    points.push_back(normalized(Vec3{u[0] - 0.5, u[1] - 0.5, u[2] - 0.5}) * 0.6);
  }
  return {sphere_solid(0.5), capsule_solid(0.3, 0.4), box_solid({0.5, 0.4, 0.3}), cylinder_solid(0.4, 0.3),
          hull_solid(points)};
}

Transform random_place(uint64_t stream, uint64_t i, double reach) {
  const auto u = uniform4(6, stream, i), v = uniform4(7, stream, i);
  return transform_of({Vec3{u[0] - 0.5, u[1] - 0.5, u[2] - 0.5} * reach,
                       normalized(Quat{v[0] - 0.5, v[1] - 0.5, v[2] - 0.5, v[3] - 0.5})});
}

/// How far b must move along the unit vector n to be clear of a.
double reach_along(const Object& a, const Object& b, const Vec3& n) {
  const auto far = [](const Object& o, const Vec3& d) {
    return dot(d, o.at.point(furthest(o.solid, o.at.inverse_direction(d))));
  };
  return far(a, n) + far(b, -n);
}

TEST(CollisionBesideLibccd, SameOverlapsAndNoLargerDepths) {
  const auto all = solids();
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = support;
  ccd.max_iterations = 200;
  ccd.epa_tolerance = 1e-7;
  int overlaps = 0, close = 0;
  for (size_t a = 0; a < all.size(); ++a) {
    for (size_t b = 0; b < all.size(); ++b) {
      for (uint64_t i = 0; i < 300; ++i) {
        const Object x{all[a], random_place(1, i, 1)}, y{all[b], random_place(2, i, 2)};
        Manifold m;
        const bool ours = collide(x.solid, x.at, y.solid, y.at, 0, m);
        ccd_real_t depth = 0;
        ccd_vec3_t dir, at;
        const int theirs = ccdGJKPenetration(&x, &y, &ccd, &depth, &dir, &at);
        if (theirs == -2) continue;  // out of memory or iterations
        // If they overlap by less than 1e-4, rounding may decide either way.
        if (ours != (theirs == 0)) {
          EXPECT_LT(ours ? m.deepest() : depth, 1e-4) << a << " " << b << " " << i;
          continue;
        }
        if (!ours) continue;
        ++overlaps;
        // In deep overlap, libccd's depth does not always belong to its own direction; the depth along that
        // direction is an upper bound of the smallest one.
        const Vec3 n = normalized(Vec3{dir.v[0], dir.v[1], dir.v[2]});
        const double bound = std::min(reach_along(x, y, n), reach_along(x, y, -n));
        // Faces are preferred to edges by a thousandth of 0.3 m; cylinders are accurate to 1e-4.
        EXPECT_LE(m.deepest(), bound + 5e-4) << a << " " << b << " " << i;
        close += std::fabs(m.deepest() - depth) < 1e-3;
      }
    }
  }
  EXPECT_GT(overlaps, 1500);
  // libccd is not always near the smallest depth; in most cases it is.
  EXPECT_GT(close, overlaps * 8 / 10);
}

}  // namespace
}  // namespace truestep
