#include "engine/collision/broad/box_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace truestep {

namespace {

double widest(const Box& b) {
  const Vec3 e = b.high - b.low;
  return std::max({e.x, e.y, e.z});
}

}  // namespace

template <class Visit>
void BoxGrid::each_cell(const Box& b, Visit&& visit) const {
  if (!std::isfinite(widest(b))) return;
  const Vec3 low = b.low - bounds_.low, high = b.high - bounds_.low;
  for (long z = cell(low.z, 2); z <= cell(high.z, 2); ++z) {
    for (long y = cell(low.y, 1); y <= cell(high.y, 1); ++y) {
      for (long x = cell(low.x, 0); x <= cell(high.x, 0); ++x) {
        visit(static_cast<size_t>((z * n_[1] + y) * n_[0] + x));
      }
    }
  }
}

void BoxGrid::build(std::span<const Box> boxes) {
  boxes_ = boxes;
  bounds_ = Box::nothing();
  double sum = 0, largest = 0, count = 0;
  for (const Box& b : boxes) {
    const double w = widest(b);
    if (!std::isfinite(w)) continue;
    bounds_.cover(b);
    sum += w, largest = std::max(largest, w), count += 1;
  }
  // As wide as the boxes are on average, but wide enough that the largest overlaps few cells and that there
  // are not many more cells than boxes.
  double size = count > 0 ? std::max(sum / count, largest / 16) : 1;
  if (!(size > 0)) size = 1;
  // Boxes at opposite ends of the range of a double are farther apart than a double holds.
  constexpr double kMost = std::numeric_limits<double>::max();
  Vec3 extent = count > 0 ? bounds_.high - bounds_.low : Vec3{};
  extent = {std::min(extent.x, kMost), std::min(extent.y, kMost), std::min(extent.z, kMost)};
  const double most = 4.0 * static_cast<double>(boxes.size()) + 64;
  for (;; size *= 1.25) {
    const double nx = std::floor(extent.x / size) + 1, ny = std::floor(extent.y / size) + 1,
                 nz = std::floor(extent.z / size) + 1;
    if (nx * ny * nz > most) continue;
    n_[0] = static_cast<long>(nx), n_[1] = static_cast<long>(ny), n_[2] = static_cast<long>(nz);
    break;
  }
  per_cell_ = 1 / size;

  // Counting sort: within a cell boxes keep their own order.
  start_.assign(static_cast<size_t>(n_[0] * n_[1] * n_[2]) + 1, 0);
  for (const Box& b : boxes) each_cell(b, [&](size_t c) { ++start_[c + 1]; });
  for (size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  list_.resize(start_.back());
  for (size_t i = 0; i < boxes.size(); ++i) {
    each_cell(boxes[i], [&](size_t c) { list_[start_[c]++] = static_cast<uint32_t>(i); });
  }
  // Filling moved each cell's start to its end.
  for (size_t c = start_.size() - 1; c > 0; --c) start_[c] = start_[c - 1];
  start_[0] = 0;
}

}  // namespace truestep
