#include "engine/neighbours/point_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace truestep {

void PointGrid::build(std::span<const double> x, double reach) {
  constexpr double kHuge = std::numeric_limits<double>::infinity();
  constexpr uint32_t kNowhere = 0xffffffff;
  const size_t n = x.size() / 3;
  const auto finite = [&x](size_t i) {
    return std::isfinite(x[3 * i]) && std::isfinite(x[3 * i + 1]) && std::isfinite(x[3 * i + 2]);
  };

  Vec3 low{kHuge, kHuge, kHuge}, high{-kHuge, -kHuge, -kHuge};
  for (size_t i = 0; i < n; ++i) {
    if (!finite(i)) continue;
    const Vec3 p = load3(x.data(), i);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  if (!(low.x <= high.x)) low = high = {};
  low_ = low;
  // At most a few cells per point; every attempt makes them a quarter larger.
  const auto most = static_cast<double>(most_cells(n));
  double size = reach, wx, wy, wz;
  // Points at opposite ends of the range of a double are farther apart than a double holds.
  const auto apart = [](double a, double b) { return std::min(b - a, std::numeric_limits<double>::max()); };
  for (;; size *= 1.25) {
    wx = std::floor(apart(low.x, high.x) / size) + 1;
    wy = std::floor(apart(low.y, high.y) / size) + 1;
    wz = std::floor(apart(low.z, high.z) / size) + 1;
    if (wx * wy * wz <= most) break;
  }
  per_cell_ = 1 / size;
  nx_ = static_cast<long>(wx), ny_ = static_cast<long>(wy), nz_ = static_cast<long>(wz);

  // Counting sort: stable, so that slots within a cell follow the points' own order.
  // Points may spread later.
  start_.reserve(most_cells(n) + 1);
  start_.assign(static_cast<size_t>(nx_ * ny_ * nz_) + 1, 0);
  cell_of_.resize(n);
  size_t inside = 0;
  for (size_t i = 0; i < n; ++i) {
    if (!finite(i)) {
      cell_of_[i] = kNowhere;
      continue;
    }
    const Vec3 p = load3(x.data(), i) - low_;
    cell_of_[i] = static_cast<uint32_t>((cell(p.z, nz_) * ny_ + cell(p.y, ny_)) * nx_ + cell(p.x, nx_));
    ++start_[cell_of_[i] + 1];
    ++inside;
  }
  for (size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  order_.resize(inside);
  sorted_.resize(3 * inside);
  // Filling moves each cell's start to its end; shifting back by one cell restores the starts.
  for (size_t i = 0; i < n; ++i) {
    if (cell_of_[i] == kNowhere) continue;
    const uint32_t slot = start_[cell_of_[i]]++;
    order_[slot] = static_cast<uint32_t>(i);
    store3(sorted_.data(), slot, load3(x.data(), i));
  }
  for (size_t c = start_.size() - 1; c > 0; --c) start_[c] = start_[c - 1];
  start_[0] = 0;
}

}  // namespace truestep
