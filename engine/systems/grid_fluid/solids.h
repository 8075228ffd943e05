// Obstacles on a staggered grid: open fractions of faces for the pressure (cut cells), solid fractions of
// the control volumes around faces, and for walls of second order the velocities in and next to an obstacle
// that follow from the fluid: along the normal n of the nearest surface, at depth phi below it,
//   u = U + (u1 - U) s (2 - s) + (u2 - U) s (s - 1) / 2,   s = phi / d1,
// the parabola through the wall's velocity U and the velocities at d1 and 2 d1 from the wall, interpolated
// linearly (ghost cells after Tseng, Ferziger 2003, "A ghost-cell immersed boundary method for flow in
// complex geometry", section 3.2; here both image points are far enough out that no face inside a solid
// contributes to them).
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
  /// How a face inside an obstacle follows from the fluid: the values around both image points (lowest face,
  /// and fraction of the higher ones along each axis) and their weights, at the face's centre (`ghost`) and
  /// for the mean over the face's open part (`flux`).
  struct Wall {
    Face face;
    Vec3 foot;  ///< m, point on the obstacle's surface
    std::array<uint32_t, 2> image;
    std::array<std::array<double, 3>, 2> share;
    std::array<double, 2> ghost, flux;
  };

  Solids() = default;
  Solids(const std::vector<ObstacleDef>& obstacles, const mac::MacGrid& grid);
  /// Places the same obstacles anew.
  void place(std::span<const ObstacleDef> obstacles, const mac::MacGrid& grid);
  /// Reserves room for other poses: shapes keep their size, so the number of cells they cut changes little.
  void set_aside();
  bool any() const { return !open[0].empty(); }
  bool is_inside(size_t c, size_t at) const { return solid_[c][at] != 0; }
  /// Whether a cell lies in an obstacle's bounding box, widened by two cells.
  bool is_near(size_t at) const { return near_[at] != 0; }

  std::array<Array, 3> open;                ///< open fraction of each face, 0 to 1
  std::array<Array, 3> fluid;               ///< fluid fraction of the volume around each face
  std::array<std::vector<Face>, 3> shut;    ///< faces not fully open, or with partly solid volumes
  std::array<std::vector<Face>, 3> inside;  ///< those with centres outside the fluid
  std::array<std::vector<Wall>, 3> walls;   ///< those next to a face with its centre in the fluid

 private:
  void measure_faces(std::span<const ObstacleDef> obstacles, const mac::MacGrid& g, size_t c);
  void find_walls(std::span<const ObstacleDef> obstacles, const mac::MacGrid& g, size_t c);
  std::vector<uint8_t> near_;                  ///< cells around obstacles
  std::array<std::vector<uint8_t>, 3> solid_;  ///< faces that are `inside`
  std::vector<double> depth_;                  ///< m, of the open part of each `inside` face of one component
};

/// Cells [first, last) around an obstacle's bounding box, widened by `beyond` cells; one more than the box
/// has along an axis where it reaches that far.
struct CellRange {
  std::array<size_t, 3> first{}, last{1, 1, 1};
};
CellRange cells_near(const ObstacleDef& obstacle, const mac::MacGrid& grid, double beyond);

/// m^3 (m^2 in the plane) of the box outside obstacles as they are placed (fluid_volume.cc).
double fluid_volume(std::span<const ObstacleDef> obstacles, const mac::MacGrid& grid);

/// m, distance from the nearest obstacle's surface, negative inside; exact outside. `which`: its number.
double distance_to(std::span<const ObstacleDef> obstacles, const Vec3& at, size_t dimensions,
                   uint32_t* which = nullptr);

}  // namespace truestep::grid_fluid
