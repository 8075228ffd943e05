// Interface of fields that know the force on one point and how it changes as that point alone moves. Points
// of one colour do not act on each other, so all of them may move at once.
#pragma once
#include <vector>

#include "engine/core/equations/force_field.h"
#include "engine/math/vec3.h"

namespace truestep {

/// Force on a point (N) and -df/dx - df/dv / h of it, positive semidefinite (N/m; xx, xy, xz, yy, yz, zz).
struct PointSlope {
  Vec3 force;
  double stiffness[6] = {};
};

/// Points with index in [begin[c], begin[c + 1]) of `points` have colour c; ascending within a colour.
struct PointColours {
  std::vector<uint32_t> points, begin;
  size_t count() const { return begin.size() - 1; }
};

class PointForces {
 public:
  virtual ~PointForces() = default;
  virtual const PointColours& colours() const = 0;
  /// Acceleration of a point without interactions, m/s^2.
  virtual Vec3 free_acceleration(const State& state) const = 0;
  /// The part of an acceleration that the point can follow: without prescribed components.
  virtual Vec3 allowed(size_t point, const Vec3& a) const { return a; }
  /// out[k] = slope of points[k]; dissipative forces take positions from `x_lagged`.
  virtual void point_slopes(const Phase& at, std::span<const double> x_lagged, double h,
                            std::span<const uint32_t> points, std::span<PointSlope> out) const = 0;
};

}  // namespace truestep
