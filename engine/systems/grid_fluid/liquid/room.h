// What a cell has room for: the sum of the weights that particles would give it if they filled all space
// outside obstacles. A cell's fill is relative to it (kernels/mac/surface.h). Only cells near obstacles are
// summed anew when these move; elsewhere the room is that of the box without them.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/base/parallel.h"
#include "engine/systems/grid_fluid/solids.h"

namespace truestep::grid_fluid {

class Room {
 public:
  using Array = std::vector<double, CacheLineAllocator<double>>;
  /// `per_axis`: particles along each axis of a cell.
  void bind(const mac::MacGrid& grid, size_t per_axis, const ThreadArena& arena);
  /// `solids` are `obstacles`, as they are placed; without any the room is that of the box.
  void measure(const Solids& solids, std::span<const ObstacleDef> obstacles, const ThreadArena& arena);
  /// Gives the cells beyond an open side full room, so that they count as empty.
  void open(size_t axis, size_t end, const ThreadArena& arena);
  /// Of each cell, in the grid's own array; 0 beyond closed sides of the box.
  const double* data() const { return room_.data(); }
  /// Far from sides and obstacles.
  double whole() const { return whole_; }

 private:
  template <size_t D>
  double sum_around(size_t at, const std::array<size_t, 3>& cell) const;
  double sum_around(size_t at, const std::array<size_t, 3>& cell) const {
    return grid_.dimensions == 2 ? sum_around<2>(at, cell) : sum_around<3>(at, cell);
  }
  uint64_t free_places(const std::array<size_t, 3>& cell, std::span<const ObstacleDef> obstacles) const;
  /// Whether the cell has a neighbour beyond the end of a periodic axis.
  bool reaches_around(const std::array<size_t, 3>& cell) const;

  mac::MacGrid grid_;
  size_t per_ = 0;
  double whole_ = 1;
  std::array<std::vector<double>, 3>
      weight_;                  ///< of the places in the cell before, itself, and the one after
  Array room_, empty_box_;      ///< with and without obstacles
  std::vector<uint64_t> free_;  ///< a bit for every place of a cell outside obstacles
};

}  // namespace truestep::grid_fluid
