// Values beyond the sides of a box, so that kernels on the staggered grid need no special cases at sides:
// mirrored about a given value, mirrored evenly, or copied from the other end.
#pragma once
#include <vector>

#include "engine/base/parallel.h"
#include "engine/kernels/mac/mac_grid.h"

namespace truestep::mac {

/// The condition of a side on one kind of values: `given` on the side, zero slope across it, periodic, or 0
/// on the side by odd reflection, as transforms have it (`odd`).
enum class Mirror : uint8_t { given, even, periodic, odd };

/// Values of one side for one place, over the padded plane of the other two axes (the lower axis fastest).
struct SideValues {
  Mirror mirror = Mirror::even;
  std::vector<double> values;  ///< empty: 0
  double at(size_t plane) const { return values.empty() ? 0 : values[plane]; }
};
/// [axis][end]
using Sides = std::array<std::array<SideValues, 2>, 3>;

/// Fills the values beyond the sides, and sets faces on sides with given values.
void fill_ghosts(const MacGrid& grid, size_t place, const Sides& sides, double* u, const ThreadArena& arena);

/// out += factor times what the Laplacian of a change that vanishes on the sides with given values (along
/// them) gains from the parabola there, compared with the mirror image that transforms assume.
void add_wall_curvature(const MacGrid& grid, size_t place, const Sides& sides, const double* change,
                        double factor, double* out, const ThreadArena& arena);

}  // namespace truestep::mac
