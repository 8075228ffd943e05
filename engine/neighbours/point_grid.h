// Points sorted by cell, so that all neighbours within a reach lie in nine runs of consecutive slots. Cells
// are cubes of at least the reach; for widely scattered points they grow, so memory stays linear in the
// number of points. The order is that of (cell, index): a function of the positions alone.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/math/vec3.h"
#include "engine/neighbours/cell_lattice.h"
#include "engine/neighbours/cell_order.h"

namespace truestep {

class PointGrid {
 public:
  /// Sorts n x 3 positions. Points that are not finite are left out.
  void build(std::span<const double> x, double reach, const ThreadArena& arena);
  /// The same by one thread.
  void build(std::span<const double> x, double reach) { build(x, reach, ThreadArena{}); }
  /// Reserves memory for this many points, so that building with fewer does not allocate.
  void reserve(size_t points) {
    order_.reserve(points, most_cells(points));
    sorted_.reserve(3 * points), extents_.reserve(points / kBlockRows + 1);
  }

  size_t size() const { return order_.size(); }
  /// Index of the point in a slot.
  uint32_t point(size_t slot) const { return order_.point(slot); }
  Vec3 position(size_t slot) const { return load3(sorted_.data(), slot); }

  /// visit(begin, end) for runs of slots that together hold every point within reach of p.
  template <class Visit>
  void near(const Vec3& p, Visit&& visit) const {
    const int c[3] = {cells_.along(p.x, 0), cells_.along(p.y, 1), cells_.along(p.z, 2)};
    cells_.inside(c, [&](size_t first, size_t end) { visit(order_.start(first), order_.start(end)); });
  }

 private:
  static constexpr size_t most_cells(size_t points) { return 4 * points + 64; }
  void fit_cells(std::span<const double> x, double reach, const ThreadArena& arena);

  CellLattice<3> cells_;
  CellOrder order_;
  std::vector<double> sorted_;
  struct Extent {
    Vec3 low, high;
  };
  std::vector<Extent> extents_;  ///< of blocks of points
};

}  // namespace truestep
