// Distance between the cores of two convex solids by Gilbert, Johnson and Keerthi (1988): the point nearest
// the origin in the difference set {a - b}, approached by simplices of furthest points. All in a's frame.
#pragma once
#include "engine/collision/pairs/convex.h"

namespace truestep {

/// Points of the difference set and the points they come from.
struct Simplex {
  Vec3 w[4], a[4], b[4];  ///< w = a - b
  double weight[4];       ///< of the point nearest the origin
  int count = 0;
};

struct CoreDistance {
  double distance = 0;  ///< m between the cores; 0: they touch or overlap
  Vec3 point_a, point_b;
  Vec3 normal;  ///< unit, from a to b; meaningless at distance 0
  Simplex simplex;
  enum class Verdict : uint8_t { separate, overlap } verdict = Verdict::separate;
};

/// `b_in_a`: the pose of b relative to a. `seed`: rough direction from a to b. Stops when the distance is
/// known to 1e-12 relative, or no longer grows because of rounding, at the latest after 128 points. With
/// `enough` >= 0 it also stops as soon as the distance is known to exceed that (m).
CoreDistance core_distance(const Convex& a, const Convex& b, const Transform& b_in_a, const Vec3& seed,
                           double enough = -1);

}  // namespace truestep
