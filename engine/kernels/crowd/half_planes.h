// Linear programmes over velocities in the plane: the point of a disc closest to a desired one within
// half-planes n . v >= c, found one half-plane at a time (Seidel 1991; de Berg et al., Computational
// Geometry, chapter 4); if there is none, the point that violates the soft ones least, by the
// three-dimensional programme of van den Berg, Guy, Lin, Manocha 2011, section 5.3.
#pragma once
#include <cstdint>
#include <span>

#include "engine/math/vec3.h"

namespace truestep::crowd {

/// Velocities v with normal . v >= offset; unit normal in z = 0, offset in m/s.
struct HalfPlane {
  Vec3 normal;
  double offset = 0;
  double lack(const Vec3& v) const { return offset - dot(normal, v); }
};

/// How the search ended: all satisfied, or which had to give.
enum class Fit : uint8_t { feasible, relaxed };
struct Chosen {
  Vec3 velocity;
  Fit fit = Fit::feasible;
};

/// The velocity of at most `speed` (m/s) closest to `wish` in all half-planes. If there is none, the one with
/// the smallest maximum violation of those from `hard` on while the first `hard` hold; these are given up
/// only if they contradict each other. At most kMostHalfPlanes; further ones are ignored.
Chosen choose_velocity(std::span<const HalfPlane> planes, size_t hard, double speed, const Vec3& wish);
inline constexpr size_t kMostHalfPlanes = 96;

}  // namespace truestep::crowd
