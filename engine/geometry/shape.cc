#include "engine/geometry/shape.h"

#include <limits>

#include "engine/math/trig.h"

namespace truestep {
namespace {
constexpr double kTwoPi = 6.283185307179586;
}

double bounding_radius(const Shape& s) {
  switch (s.kind) {
    case ShapeKind::plane:
      return std::numeric_limits<double>::infinity();
    case ShapeKind::box:
      return norm(s.size);
    case ShapeKind::sphere:
      return s.size.x;
    case ShapeKind::capsule:
      break;
  }
  return s.size.x + s.size.y;
}

bool ShapeMotion::at_rest() const {
  return velocity == Vec3{} && (amplitude == Vec3{} || frequency == 0) && spin == Vec3{};
}

Pose moved(const Pose& start, const ShapeMotion& m, double t) {
  Pose pose = start;
  pose.position += m.velocity * t;
  if (m.frequency != 0 && m.amplitude != Vec3{}) {
    // fmod is exact, so a long run keeps the phase's precision.
    const double turn = std::fmod(m.frequency * t, 1.0) * kTwoPi;
    pose.position += m.amplitude * (trig::sin(turn + m.phase) - trig::sin(m.phase));
  }
  const double rate = norm(m.spin);
  if (rate > 0) {
    const double half = 0.5 * std::fmod(rate * t, 2 * kTwoPi);
    const Vec3 axis = m.spin * (trig::sin(half) / rate);
    pose.orientation = normalized(Quat{trig::cos(half), axis.x, axis.y, axis.z} * start.orientation);
  }
  return pose;
}

}  // namespace truestep
