#include "engine/systems/grid_fluid/liquid/room.h"

#include <algorithm>
#include <cmath>

#include "engine/kernels/mac/surface.h"

namespace truestep::grid_fluid {

using mac::kCentre;

namespace {
constexpr uint64_t kAll = ~uint64_t{0};
}

void Room::bind(const mac::MacGrid& grid, size_t per_axis, const ThreadArena& arena) {
  grid_ = grid, per_ = per_axis;
  whole_ = 1;
  for (size_t a = 0; a < grid.dimensions; ++a) whole_ *= static_cast<double>(per_);
  for (size_t d = 0; d < 3; ++d) {
    weight_[d].resize(per_);
    for (size_t m = 0; m < per_; ++m) {
      const double place =
          (static_cast<double>(m) + 0.5) / static_cast<double>(per_) + static_cast<double>(d) - 1;
      weight_[d][m] = std::max(0.0, 1 - std::abs(place - 0.5));
    }
  }
  room_.assign(grid.size(), 0), empty_box_.assign(grid.size(), 0), free_.assign(grid.size(), kAll);
  mac::for_rows(grid_, kCentre, arena, [&](size_t at, size_t j, size_t k, size_t n) {
    for (size_t i = 0; i < n; ++i) empty_box_[at + i] = sum_around(at + i, {i, j, k});
  });
}

void Room::open(size_t a, size_t end, const ThreadArena& arena) {
  const size_t s = grid_.stride(a),
               beyond = (end == 0 ? mac::kGhosts - 1 : mac::kGhosts + grid_.cells[a]) * s;
  mac::for_lines(grid_, a, arena, [&](size_t line) { room_[line + beyond] = whole_; });
}

template <size_t D>
double Room::sum_around(size_t at, const std::array<size_t, 3>& cell) const {
  double sum = 0;
  // Beside a side the cell keeps what is spread beyond it (mac::fold_cells).
  const auto weight = [&](size_t a, size_t d, size_t m) {
    double w = weight_[d][m];
    if (d != 1 || grid_.periodic[a]) return w;
    if (cell[a] == 0) w += weight_[2][m];
    if (cell[a] + 1 == grid_.cells[a]) w += weight_[0][m];
    return w;
  };
  // Neighbours along each axis; those beyond a side that is not periodic do not exist.
  const auto neighbour = [&](size_t a, size_t d, ptrdiff_t& step) {
    const auto s = static_cast<ptrdiff_t>(grid_.stride(a)), n = static_cast<ptrdiff_t>(grid_.cells[a]);
    step = (static_cast<ptrdiff_t>(d) - 1) * s;
    const bool beyond = d == 0 ? cell[a] == 0 : d == 2 && cell[a] + 1 == grid_.cells[a];
    if (beyond) step += d == 0 ? n * s : -n * s;
    return !beyond || grid_.periodic[a];
  };
  for (size_t dk = D == 3 ? 0 : 1; dk < (D == 3 ? 3 : 2); ++dk) {
    ptrdiff_t step_k = 0;
    if (D == 3 && !neighbour(2, dk, step_k)) continue;
    for (size_t dj = 0; dj < 3; ++dj) {
      ptrdiff_t step_j = 0;
      if (!neighbour(1, dj, step_j)) continue;
      for (size_t di = 0; di < 3; ++di) {
        ptrdiff_t step_i = 0;
        if (!neighbour(0, di, step_i)) continue;
        uint64_t bits = free_[at + static_cast<size_t>(step_i + step_j + step_k)];
        for (size_t k = 0; k < (D == 3 ? per_ : 1); ++k) {
          for (size_t j = 0; j < per_; ++j) {
            const double w = (D == 3 ? weight(2, dk, k) : 1) * weight(1, dj, j);
            for (size_t i = 0; i < per_; ++i, bits >>= 1) {
              if (bits & 1) sum += w * weight(0, di, i);
            }
          }
        }
      }
    }
  }
  return sum;
}

uint64_t Room::free_places(const std::array<size_t, 3>& cell, std::span<const ObstacleDef> obstacles) const {
  const bool space = grid_.dimensions == 3;
  const auto place = [&](size_t a, size_t m) {
    const double cells = (static_cast<double>(cell[a] * per_ + m) + 0.5) / static_cast<double>(per_);
    return grid_.origin[a] + grid_.spacing[a] * cells;
  };
  uint64_t free = kAll, bit = 1;
  for (size_t k = 0; k < (space ? per_ : 1); ++k) {
    for (size_t j = 0; j < per_; ++j) {
      for (size_t i = 0; i < per_; ++i, bit <<= 1) {
        const Vec3 at{place(0, i), place(1, j), space ? place(2, k) : 0};
        if (distance_to(obstacles, at, grid_.dimensions) <= 0) free &= ~bit;
      }
    }
  }
  return free;
}

bool Room::reaches_around(const std::array<size_t, 3>& cell) const {
  for (size_t a = 0; a < grid_.dimensions; ++a) {
    if (grid_.periodic[a] && (cell[a] == 0 || cell[a] + 1 == grid_.cells[a])) return true;
  }
  return false;
}

void Room::measure(const Solids& solids, std::span<const ObstacleDef> obstacles, const ThreadArena& arena) {
  if (solids.any()) {
    mac::for_rows(grid_, kCentre, arena, [&](size_t at, size_t j, size_t k, size_t n) {
      for (size_t i = 0; i < n; ++i)
        free_[at + i] = solids.is_near(at + i) ? free_places({i, j, k}, obstacles) : kAll;
    });
  }
  // A cell that is not near an obstacle has no neighbour with a place inside one, unless across the box.
  mac::for_rows(grid_, kCentre, arena, [&](size_t at, size_t j, size_t k, size_t n) {
    for (size_t i = 0; i < n; ++i) {
      const bool anew = solids.any() && (solids.is_near(at + i) || reaches_around({i, j, k}));
      room_[at + i] = anew ? sum_around(at + i, {i, j, k}) : empty_box_[at + i];
    }
  });
  mac::wrap_periodic(grid_, room_.data(), arena);
}

}  // namespace truestep::grid_fluid
