// Closed forms for balls and capsules against each other, and balls against boxes, cylinders, hulls and
// triangles. All in a's frame, normal from a to b, points at most `margin` (m) apart; out.count = 0: none.
#pragma once
#include "engine/collision/pairs/convex.h"
#include "engine/collision/pairs/manifold.h"

namespace truestep {

/// Balls of the given radii; b's centre as seen from a.
void collide_spheres(double ra, double rb, const Vec3& center, double margin, Manifold& out);
/// Any convex a except a plane against a ball of radius r about `center`.
void collide_sphere(const Convex& a, double r, const Vec3& center, double margin, Manifold& out);
/// Nearly parallel capsules get two points.
void collide_capsules(const Convex& a, const Convex& b, const Transform& b_in_a, double margin,
                      Manifold& out);

/// Points where two rounded segments lie side by side: segments p0 p1 and q0 q1 with radii ra, rb, pressed
/// along the unit vector n (from p to q). Adds nothing when they are not parallel within 0.05 rad or do not
/// overlap lengthwise.
void line_contact(const Vec3 (&p)[2], double ra, const Vec3 (&q)[2], double rb, const Vec3& n, double margin,
                  Manifold& out);

/// Nearest points of two segments, as fractions along them (Ericson 2005, section 5.1.9).
struct SegmentPair {
  double s, t;
};
SegmentPair nearest_on_segments(const Vec3& p, const Vec3& d, const Vec3& q, const Vec3& e);

}  // namespace truestep
