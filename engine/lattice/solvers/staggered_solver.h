// (shift I - step lap) x = b on a staggered grid with homogeneous sides, by transforms along every axis: the
// waves on cells are those on a line of twice as many nodes of which only the odd ones hold values (DCT-II,
// DST-II and their mixed kinds; Strang 1999, "The discrete cosine transform"). Exact to rounding.
#pragma once
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/base/parallel.h"
#include "engine/kernels/mac/ghosts.h"
#include "engine/math/solvers/trig_transform.h"

namespace truestep::lattice {

class StaggeredSolver {
 public:
  /// The differences that `lap` is made of: second order, fourth order (kernels/mac/fourth_order.h), or the
  /// divergence of the fourth-order gradient, which a projection needs.
  enum class Differences : uint8_t { second, fourth, fourth_divergence };
  /// For values at `place` (mac::kCentre or an axis of faces); given sides are zero.
  StaggeredSolver(const mac::MacGrid& grid, size_t place,
                  const std::array<std::array<mac::Mirror, 2>, 3>& mirrors,
                  Differences differences = Differences::second);

  /// In place; faces on sides with given values are neither read nor written. If shift is 0 and a constant
  /// solves the homogeneous equation, the mean of b is ignored and that of x is 0.
  void solve(double shift, double step, double* x, const ThreadArena& arena);

 private:
  struct AxisWaves {
    TrigTransform transform;
    size_t first = 0, count = 0;             ///< unknowns among the values of the grid
    bool doubled = false;                    ///< cells between the ends: every other node of a finer line
    std::vector<size_t> node;                ///< index of unknown i in the transform's line
    std::vector<size_t> wave;                ///< index of coefficient i in the transform's line
    std::vector<double> weight, eigenvalue;  ///< 1, 1/m^2
  };
  static AxisWaves waves(const mac::MacGrid& grid, size_t place, size_t axis,
                         const std::array<mac::Mirror, 2>& mirrors);
  enum class Way : uint8_t { forward, backward };
  void transform(size_t axis, Way way, const ThreadArena& arena);
  void lines(const AxisWaves& w, Way way, double* x, size_t stride, size_t line_stride, size_t count,
             double* scratch) const;

  mac::MacGrid grid_;
  std::vector<AxisWaves> axes_;
  std::array<size_t, 3> counts_{1, 1, 1};
  std::vector<double, CacheLineAllocator<double>> x_;
};

}  // namespace truestep::lattice
