// Boxes sorted into the cells of a grid that they overlap, for finding the boxes near another one. Cells are
// about as large as the boxes; memory is linear in the number of boxes, whatever their sizes. The order of
// results is a function of the boxes alone.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/box.h"

namespace truestep {

class BoxGrid {
 public:
  /// Sorts the boxes, which must stay valid while the grid is queried. Boxes that are not finite are left
  /// out.
  void build(std::span<const Box> boxes);
  /// Box around all boxes.
  const Box& bounds() const { return bounds_; }

  /// visit(index) for every box that overlaps `b`, each once.
  template <class Visit>
  void overlapping(const Box& b, Visit&& visit) const {
    if (!bounds_.overlaps(b)) return;
    const long x0 = cell(b.low.x - bounds_.low.x, 0), x1 = cell(b.high.x - bounds_.low.x, 0);
    const long y0 = cell(b.low.y - bounds_.low.y, 1), y1 = cell(b.high.y - bounds_.low.y, 1);
    const long z0 = cell(b.low.z - bounds_.low.z, 2), z1 = cell(b.high.z - bounds_.low.z, 2);
    for (long z = z0; z <= z1; ++z) {
      for (long y = y0; y <= y1; ++y) {
        for (long x = x0; x <= x1; ++x) {
          const auto c = static_cast<size_t>((z * n_[1] + y) * n_[0] + x);
          for (uint32_t k = start_[c]; k < start_[c + 1]; ++k) {
            const Box& other = boxes_[list_[k]];
            if (!b.overlaps(other)) continue;
            // A pair meets in several cells; it counts in the cell with the lower corner of their common box.
            const auto first = [&](double p, double q, double origin, size_t axis) {
              return cell((p > q ? p : q) - origin, axis);
            };
            if (first(b.low.x, other.low.x, bounds_.low.x, 0) == x &&
                first(b.low.y, other.low.y, bounds_.low.y, 1) == y &&
                first(b.low.z, other.low.z, bounds_.low.z, 2) == z) {
              visit(list_[k]);
            }
          }
        }
      }
    }
  }

 private:
  long cell(double offset, size_t axis) const {
    const double c = offset * per_cell_;
    if (!(c > 0)) return 0;
    return c < static_cast<double>(n_[axis]) ? static_cast<long>(c) : n_[axis] - 1;
  }
  template <class Visit>
  void each_cell(const Box& b, Visit&& visit) const;

  std::span<const Box> boxes_;
  Box bounds_;
  double per_cell_ = 1;
  long n_[3] = {1, 1, 1};
  std::vector<uint32_t> start_, list_;
};

}  // namespace truestep
