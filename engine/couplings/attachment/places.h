// A place on a body and a point: the arm to it, and the point as seen from there.
#pragma once
#include <cstdint>

#include "engine/math/quaternion.h"

namespace truestep::attachment {

/// From the centre of mass to a place in the body's frame, in that of the world.
inline Vec3 arm_of(const auto& bodies, uint32_t body, const Vec3& place) {
  return rotation(bodies.orientation(body)).apply(place);
}

/// r of a pair.
inline Vec3 separation(const auto& points, size_t point, const auto& bodies, uint32_t body,
                       const Vec3& place) {
  return points.place(point) - bodies.place(body) - arm_of(bodies, body, place);
}

}  // namespace truestep::attachment
