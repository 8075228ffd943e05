// Connected bodies of liquid on a staggered grid: cells of liquid belong together if a face of weight > 0
// joins them, directly or through others. Runs of cells along x are joined to those of the rows before
// (Rosenfeld, Pfaltz 1966, "Sequential operations in digital picture processing").
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "engine/base/parallel.h"
#include "engine/kernels/mac/mac_grid.h"

namespace truestep::mac {

/// Numbers bodies 1, 2, ... in the order of their first cells, writes each cell's to `body` (ghosts of
/// periodic axes included) and returns how many there are. A cell without liquid has the number of a cell of
/// liquid beside it that a face joins it to, the lower one along the first such axis, else 0. `liquid` and
/// `faces` are wrapped if the grid is periodic; `scratch`: at least one more than there are cells.
uint32_t number_bodies(const MacGrid& grid, const uint8_t* liquid, const std::array<const double*, 3>& faces,
                       uint32_t* body, std::span<uint32_t> scratch, const ThreadArena& arena);

}  // namespace truestep::mac
