// Nearest points of two segments when both are interior: the common perpendicular of their lines,
//   d1 = a1 - a0, d2 = b1 - b0, r = a0 - b0,   (d1.d1)(d2.d2) - (d1.d2)^2 > 0
// (Ericson 2005, "Real-Time Collision Detection", section 5.1.9, without the clamped cases).
#pragma once
#include <optional>

#include "engine/math/vec3.h"

namespace truestep {

struct NearestInside {
  double a = 0, b = 0;  ///< fractions of the way from a0 to a1 and from b0 to b1, between 0 and 1
  Vec3 apart;           ///< m, from the point on b to that on a
};

/// Empty if one of the nearest points is an end, or if the segments are parallel to 1e-6.
inline std::optional<NearestInside> nearest_inside(const Vec3& a0, const Vec3& a1, const Vec3& b0,
                                                   const Vec3& b1) {
  const Vec3 d1 = a1 - a0, d2 = b1 - b0, r = a0 - b0;
  const double a = norm2(d1), e = norm2(d2), b = dot(d1, d2), c = dot(d1, r), f = dot(d2, r);
  const double denominator = a * e - b * b;
  if (!(denominator > 1e-12 * a * e)) return std::nullopt;
  const double s = b * f - c * e, t = a * f - b * c;
  if (!(s > 0 && s < denominator && t > 0 && t < denominator)) return std::nullopt;
  NearestInside out{s / denominator, t / denominator, {}};
  out.apart = r + d1 * out.a - d2 * out.b;
  return out;
}

}  // namespace truestep
