// Tetrahedra that fill a region by isosurface stuffing (Labelle, Shewchuk 2007, "Isosurface stuffing: fast
// tetrahedral meshes with good dihedral angles", ACM Transactions on Graphics 26(3), 57): a body-centred
// cubic lattice is laid over it; lattice points close to the surface move onto it; the lattice's tetrahedra
// inside are then cut along the surface by a few patterns. The surface is smooth on the scale of the lattice:
// sharper edges and corners of the region are rounded off.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/geometry/box.h"

namespace truestep {

/// A region to be filled.
class Region {
 public:
  virtual ~Region() = default;
  virtual Box bounds() const = 0;
  virtual double volume() const = 0;  ///< m^3
  virtual bool inside(const Vec3& p) const = 0;
  /// Where the segment from a point inside to one outside leaves the region, as a fraction in (0, 1).
  virtual double leaves(const Vec3& in, const Vec3& out) const = 0;
};

std::unique_ptr<Region> ball_region(const Vec3& center, double radius);
/// Flat ends.
std::unique_ptr<Region> cylinder_region(const Vec3& from, const Vec3& to, double radius);
/// The inside of a closed surface whose triangles run anticlockwise as seen from outside or from inside.
std::unique_ptr<Region> surface_region(std::vector<Vec3> vertices,
                                       std::vector<std::array<uint32_t, 3>> triangles);
/// Why triangles do not form a closed surface, in words: the first edge that does not have exactly two; empty
/// when they do. `triangle`: one of those at fault.
struct SurfaceFault {
  size_t triangle;
  std::string what;
};
std::optional<SurfaceFault> surface_fault(std::span<const std::array<uint32_t, 3>> triangles);

struct Stuffing {
  std::vector<Vec3> x;                              ///< m
  std::vector<std::array<uint32_t, 4>> tetrahedra;  ///< of positive volume
  double least_angle = 0, largest_angle = 0;        ///< rad, between faces of an element
};
/// `spacing`: m, of each of the two interleaved cubic lattices. Empty when the region is finer than that.
Stuffing stuff(const Region& region, double spacing);
/// Approximate numbers of nodes and tetrahedra that result.
struct StuffingSize {
  double nodes, tetrahedra;
};
StuffingSize stuffing_size(double volume, double spacing);

/// Smallest and largest angle between faces (rad).
std::array<double, 2> dihedral_angles(std::span<const Vec3> x,
                                      std::span<const std::array<uint32_t, 4>> tetrahedra);

}  // namespace truestep
