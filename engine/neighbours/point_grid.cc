#include "engine/neighbours/point_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace truestep {
namespace {

bool is_finite(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

}  // namespace

void PointGrid::fit_cells(std::span<const double> x, double reach, const ThreadArena& arena) {
  constexpr double kHuge = std::numeric_limits<double>::infinity();
  const size_t n = x.size() / 3;
  const auto cover = [](Extent& e, const Vec3& low, const Vec3& high) {
    e.low = {std::min(e.low.x, low.x), std::min(e.low.y, low.y), std::min(e.low.z, low.z)};
    e.high = {std::max(e.high.x, high.x), std::max(e.high.y, high.y), std::max(e.high.z, high.z)};
  };
  constexpr Extent kNothing{{kHuge, kHuge, kHuge}, {-kHuge, -kHuge, -kHuge}};
  extents_.assign((n + kBlockRows - 1) / kBlockRows, kNothing);
  arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    Extent e = kNothing;
    for (size_t i = begin; i < end; ++i) {
      const Vec3 p = load3(x.data(), i);
      if (is_finite(p)) cover(e, p, p);
    }
    extents_[begin / kBlockRows] = e;
  });
  Extent all = kNothing;
  for (const Extent& e : extents_) cover(all, e.low, e.high);
  if (!(all.low.x <= all.high.x)) all = {};
  const double low[3] = {all.low.x, all.low.y, all.low.z}, high[3] = {all.high.x, all.high.y, all.high.z};
  // At most a few cells per point; every attempt makes them a quarter larger.
  const auto most = static_cast<double>(most_cells(n));
  double size = reach, along[3];
  for (;; size *= 1.25) {
    for (size_t a = 0; a < 3; ++a) {
      // Points at opposite ends of the range of a double are farther apart than a double holds.
      along[a] = std::floor(std::min(high[a] - low[a], std::numeric_limits<double>::max()) / size) + 1;
    }
    if (along[0] * along[1] * along[2] <= most) break;
  }
  for (int a = 0; a < 3; ++a) {
    cells_.low[a] = low[a], cells_.width[a] = high[a] - low[a];
    cells_.per_metre[a] = 1 / size, cells_.count[a] = static_cast<int>(along[a]);
  }
}

void PointGrid::build(std::span<const double> x, double reach, const ThreadArena& arena) {
  fit_cells(x, reach, arena);
  const size_t n = x.size() / 3;
  // Points may spread later.
  order_.reserve(n, most_cells(n));
  order_.sort(
      n, cells_.cells(),
      [&](size_t i) -> size_t {
        const Vec3 p = load3(x.data(), i);
        if (!is_finite(p)) return CellOrder::kNone;
        const int c[3] = {cells_.along(p.x, 0), cells_.along(p.y, 1), cells_.along(p.z, 2)};
        return cells_.of(c);
      },
      arena);
  sorted_.resize(3 * order_.size());
  arena.for_blocks(order_.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) store3(sorted_.data(), k, load3(x.data(), order_.point(k)));
  });
}

}  // namespace truestep
