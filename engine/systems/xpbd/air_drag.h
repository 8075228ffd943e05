// Air on the faces of a body or, where it has none, along its links (kernels/air.h): pressure along the
// normal of a face, which drags and lifts. The points of a face share its force; sums are taken point by
// point.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/systems/xpbd/body.h"

namespace truestep::xpbd {

/// Half the density of air times the coefficient of drag (kg/m^3), and how the wind comes and goes.
struct AirOptions {
  double factor = 0, gust = 0, gust_period = 2;
};

/// Rows of four of a substep (solver.h); velocities are changed.
template <class T>
struct AirRows {
  const double* start;  ///< places where rows are 0, three a point
  const T* rows;
  T* velocity;
};

/// Triangles and, of every row, those that it belongs to.
struct AirFaces {
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<uint32_t> begin, at;

  /// `corners`: three rows a triangle. Allocates when there are more rows than ever before.
  void build(std::span<const uint32_t> corners, size_t rows);
};

class AirDrag {
 public:
  AirDrag(const Body& body, const AirOptions& options, double thickness);

  /// What air at velocity `wind` makes of velocities in h seconds, beside gravity: the force at the start,
  /// lessened by what it would itself take from the motion (one Newton step of implicit Euler), so that it
  /// slows light cloth without turning it round. `torn`: the faces where they are not those of the start, or
  /// null. `impulses`: scratch.
  template <class T>
  void blow(const Vec3& wind, const Vec3& gravity, double h, const AirRows<T>& on, const AirFaces* torn,
            std::vector<Vec3>& impulses, const ThreadArena& arena) const;
  const AirOptions& options() const { return options_; }

 private:
  AirOptions options_;
  AirFaces faces_;
  std::vector<double> section_;  // m^2 per point; empty where there are triangles
};

}  // namespace truestep::xpbd
