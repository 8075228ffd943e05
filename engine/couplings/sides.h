// What factories of couplings check about the two systems.
#pragma once
#include "engine/base/errors.h"
#include "engine/core/coupling.h"

namespace truestep {

/// The columns of a side's points; Error "scene_invalid" about `member` ("a" or "b") when it has none.
inline PointPort require_points(const CouplingSide& side, const std::string& member) {
  if (const auto points = side.system.ports().points) return *points;
  const std::string why = "\"" + side.id + "\" has no points that a coupling could reach";
  throw Error("scene_invalid", why,
              {{"/" + member, "unsuitable_system", why, '"' + side.id + '"', "a system of points", "", ""}});
}

/// Gives `impulse` (N s) to a row and the opposite to another.
inline void exchange_impulse(double* va, size_t a, double wa, double* vb, size_t b, double wb,
                             const Vec3& on_b) {
  store3(va, a, load3(va, a) - on_b * wa);
  store3(vb, b, load3(vb, b) + on_b * wb);
}

}  // namespace truestep
