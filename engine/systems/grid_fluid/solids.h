// Obstacles on a staggered grid: open shares of faces for the pressure (cut cells), and shares of the control
// volumes around faces that are solid, in which the fluid is at rest.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/systems/grid_fluid/grid_fluid_def.h"

namespace truestep::grid_fluid {

struct Solids {
  using Array = std::vector<double, CacheLineAllocator<double>>;
  Solids() = default;
  Solids(const std::vector<ObstacleDef>& obstacles, const mac::MacGrid& grid);
  bool any() const { return !open[0].empty(); }
  std::array<Array, 3> open;   ///< share of each face that is fluid, 0 to 1
  std::array<Array, 3> fluid;  ///< share of the volume around each face that is fluid
};

/// m, from the nearest obstacle's surface, negative inside; exact outside.
double distance_to(std::span<const ObstacleDef> obstacles, const Vec3& at, size_t dimensions);

}  // namespace truestep::grid_fluid
