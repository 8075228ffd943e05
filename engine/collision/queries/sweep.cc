#include "engine/collision/queries/sweep.h"

#include <cmath>

#include "engine/math/trig.h"

namespace truestep {

Transform Sweep::at(double t) const {
  const double angle = norm(turn);
  Transform out{rotation(from.orientation), from.position + move * t};
  if (angle > 0) {
    const trig::SinCos half = trig::sincos(0.5 * t * angle);
    const Vec3 v = turn * (half.sin / angle);
    out.rotation = rotation(normalized(Quat{half.cos, v.x, v.y, v.z} * from.orientation));
  }
  return out;
}

Sweep sweep_between(const Pose& from, const Pose& to) {
  const Quat& q = from.orientation;
  Quat d = to.orientation * Quat{q.w, -q.x, -q.y, -q.z};
  if (d.w < 0) d = {-d.w, -d.x, -d.y, -d.z};
  const Vec3 v{d.x, d.y, d.z};
  const double s = norm(v);
  // Below 1e-8 rad the angle is twice the sine.
  const double scale = s > 1e-8 ? 2 * trig::atan2(s, d.w) / s : 2;
  return {from, to.position - from.position, v * scale};
}

}  // namespace truestep
