// Obstacles on a staggered grid: open shares of faces for the pressure (cut cells), shares of the control
// volumes around faces that are solid, and for walls of second order what velocities in and beside an
// obstacle follow from the fluid: along the normal n of the nearest surface, at depth phi from it,
//   u = U + (u1 - U) s (2 - s) + (u2 - U) s (s - 1) / 2,   s = phi / d1,
// the parabola through the wall's velocity U and the velocities at d1 and 2 d1 from the wall, interpolated
// linearly (ghost cells after Tseng, Ferziger 2003, "A ghost-cell immersed boundary method for flow in
// complex geometry", section 3.2; here with both image points at distances that no face in a solid has a
// weight at).
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/systems/grid_fluid/grid_fluid_def.h"

namespace truestep::grid_fluid {

struct Solids {
  using Array = std::vector<double, CacheLineAllocator<double>>;
  /// A face and the obstacle nearest to it.
  struct Face {
    uint32_t at, obstacle;
  };
  /// How a face in an obstacle follows from the fluid: the values around both image points (lowest face and
  /// share of the higher ones along each axis) and their weights, at the face's centre (`ghost`) and in the
  /// mean of the face's open part (`flux`).
  struct Wall {
    Face face;
    Vec3 foot;  ///< m, the place on the obstacle's surface
    std::array<uint32_t, 2> image;
    std::array<std::array<double, 3>, 2> share;
    std::array<double, 2> ghost, flux;
  };

  Solids() = default;
  Solids(const std::vector<ObstacleDef>& obstacles, const mac::MacGrid& grid);
  /// Other places of the same obstacles.
  void place(std::span<const ObstacleDef> obstacles, const mac::MacGrid& grid);
  /// Room for the faces of other places: shapes keep their size, cells that they cut change by a few.
  void set_aside();
  bool any() const { return !open[0].empty(); }
  bool is_inside(size_t c, size_t at) const { return solid_[c][at] != 0; }

  std::array<Array, 3> open;                ///< share of each face that is fluid, 0 to 1
  std::array<Array, 3> fluid;               ///< share of the volume around each face that is fluid
  std::array<std::vector<Face>, 3> shut;    ///< faces that are not all open, or their volumes not all fluid
  std::array<std::vector<Face>, 3> inside;  ///< those whose centre is not in the fluid
  std::array<std::vector<Wall>, 3> walls;   ///< those next to a face whose centre is

 private:
  void measure_faces(std::span<const ObstacleDef> obstacles, const mac::MacGrid& g, size_t c);
  void find_walls(std::span<const ObstacleDef> obstacles, const mac::MacGrid& g, size_t c);
  std::vector<uint8_t> near_;                  ///< cells around obstacles
  std::array<std::vector<uint8_t>, 3> solid_;  ///< faces that are `inside`
  std::vector<double> depth_;  ///< m, of the open part of each face that is `inside` of one component
};

/// m, from the nearest obstacle's surface, negative inside; exact outside. `which`: its number.
double distance_to(std::span<const ObstacleDef> obstacles, const Vec3& at, size_t dimensions,
                   uint32_t* which = nullptr);

}  // namespace truestep::grid_fluid
