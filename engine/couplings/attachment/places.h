// A place on a body and a point: the arm to the place, and the point relative to it.
#pragma once
#include <cstdint>

#include "engine/math/quaternion.h"

namespace truestep::attachment {

/// The world vector from the centre of mass to a place given in the body's frame.
inline Vec3 arm_of(const auto& bodies, uint32_t body, const Vec3& place) {
  return rotation(bodies.orientation(body)).apply(place);
}

/// r of a pair.
inline Vec3 separation(const auto& points, size_t point, const auto& bodies, uint32_t body,
                       const Vec3& place) {
  return points.place(point) - bodies.place(body) - arm_of(bodies, body, place);
}

}  // namespace truestep::attachment
