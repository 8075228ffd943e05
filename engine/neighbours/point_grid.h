// Points sorted by cell, so that all neighbours within a reach lie in nine runs of consecutive slots. Cells
// are cubes of at least the reach; for widely scattered points they grow, so memory stays linear in the
// number of points. The order is that of (cell, index): a function of the positions alone.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

class PointGrid {
 public:
  /// Sorts n x 3 positions. Points that are not finite are left out.
  void build(std::span<const double> x, double reach);
  /// Reserves memory for this many points, so that building with fewer does not allocate.
  void reserve(size_t points) {
    order_.reserve(points), cell_of_.reserve(points), sorted_.reserve(3 * points);
    start_.reserve(most_cells(points) + 1);
  }

  size_t size() const { return order_.size(); }
  /// Index of the point in a slot.
  uint32_t point(size_t slot) const { return order_[slot]; }
  Vec3 position(size_t slot) const { return load3(sorted_.data(), slot); }

  /// visit(begin, end) for runs of slots that together hold every point within reach of p.
  template <class Visit>
  void near(const Vec3& p, Visit&& visit) const {
    const long cx = cell(p.x - low_.x, nx_), cy = cell(p.y - low_.y, ny_), cz = cell(p.z - low_.z, nz_);
    const long x0 = cx > 0 ? cx - 1 : 0, x1 = cx + 1 < nx_ ? cx + 1 : nx_ - 1;
    for (long z = cz > 0 ? cz - 1 : 0; z <= cz + 1 && z < nz_; ++z) {
      for (long y = cy > 0 ? cy - 1 : 0; y <= cy + 1 && y < ny_; ++y) {
        const long row = (z * ny_ + y) * nx_;
        visit(start_[static_cast<size_t>(row + x0)], start_[static_cast<size_t>(row + x1 + 1)]);
      }
    }
  }

 private:
  static constexpr size_t most_cells(size_t points) { return 4 * points + 64; }
  long cell(double offset, long n) const {
    const double c = offset * per_cell_;
    if (!(c > 0)) return 0;
    return c < static_cast<double>(n) ? static_cast<long>(c) : n - 1;
  }
  Vec3 low_;
  double per_cell_ = 1;
  long nx_ = 1, ny_ = 1, nz_ = 1;
  std::vector<uint32_t> start_, order_, cell_of_;
  std::vector<double> sorted_;
};

}  // namespace truestep
