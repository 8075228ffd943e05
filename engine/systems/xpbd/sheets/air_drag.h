// Air acting on the faces of a body or, if it has none, along its links (kernels/springs/air.h): a pressure
// along the face normal, which gives drag and lift. The points of a face share its force; sums are taken
// point by point.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/systems/xpbd/body.h"

namespace truestep::xpbd {

/// Half the air density times the drag coefficient (kg/m^3), and how the wind varies in time.
struct AirOptions {
  double factor = 0, gust = 0, gust_period = 2;
};

/// The rows of a substep, four numbers each (solver.h); velocities are changed.
template <class T>
struct AirRows {
  const double* start;  ///< positions at which rows are 0, three numbers a point
  const T* rows;
  T* velocity;
};

/// Triangles and, for every row, the triangles it belongs to.
struct AirFaces {
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<uint32_t> begin, at;

  /// `corners`: three rows a triangle. Allocates only when there are more rows than ever before.
  void build(std::span<const uint32_t> corners, size_t rows);
};

class AirDrag {
 public:
  AirDrag(const Body& body, const AirOptions& options, double thickness);

  /// Applies air that moves with `wind` to the velocities over h seconds, as they will be after gravity
  /// (which is not applied here): the force at the start, reduced by the drag that the resulting motion would
  /// lose (one Newton step of implicit Euler), so that it slows light cloth without reversing it. `torn`: the
  /// faces where they differ from those at the start, or null. `impulses`: scratch.
  template <class T>
  void blow(const Vec3& wind, const Vec3& gravity, double h, const AirRows<T>& on, const AirFaces* torn,
            std::vector<Vec3>& impulses, const ThreadArena& arena) const;
  const AirOptions& options() const { return options_; }

 private:
  AirOptions options_;
  AirFaces faces_;
  std::vector<double> section_;  // m^2 per point; empty if there are triangles
};

}  // namespace truestep::xpbd
