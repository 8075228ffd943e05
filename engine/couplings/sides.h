// Checks on the two systems shared by the couplings' factories, and exchanges between their points.
#pragma once
#include "engine/base/errors.h"
#include "engine/core/coupling.h"

namespace truestep {

/// The columns of a side's points; Error "scene_invalid" about `member` ("a" or "b") when it has none.
inline PointPort require_points(const CouplingSide& side, const std::string& member) {
  if (const auto points = side.system.ports().points) return *points;
  const std::string why = "\"" + side.id + "\" has no points that a coupling could reach";
  throw Error("scene_invalid", why,
              {"/" + member, "unsuitable_system", why, '"' + side.id + '"',
               "a system of points (mass_spring, particles) or, on one side, of bodies (rigid3d)", "", ""});
}

/// Gives `impulse` (N s) to a row and the opposite to another.
inline void exchange_impulse(Points& a, size_t row_a, double wa, Points& b, size_t row_b, double wb,
                             const Vec3& on_b) {
  a.accelerate(row_a, -on_b * wa);
  b.accelerate(row_b, on_b * wb);
}
/// Moves a row by `on_b` (kg m) over its mass and the other row the opposite way.
inline void exchange_shift(Points& a, size_t row_a, double wa, Points& b, size_t row_b, double wb,
                           const Vec3& on_b) {
  a.shift(row_a, -on_b * wa);
  b.shift(row_b, on_b * wb);
}

}  // namespace truestep
