// Tetrahedra that fill a region by isosurface stuffing (Labelle, Shewchuk 2007, "Isosurface stuffing: fast
// tetrahedral meshes with good dihedral angles", ACM Transactions on Graphics 26(3), 57): a body-centred
// cubic lattice is laid over it; lattice points that the surface passes closely move onto it; what is left of
// the lattice's tetrahedra inside is cut along the surface by a few patterns. The surface is smooth to within
// the lattice: edges and corners of the region sharper than that are rounded off.
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

/// What is to be filled.
class Region {
 public:
  virtual ~Region() = default;
  virtual Box bounds() const = 0;
  virtual double volume() const = 0;  ///< m^3
  virtual bool inside(const Vec3& p) const = 0;
  /// Where the way from a place inside to one outside leaves the region: the share of it, in (0, 1).
  virtual double leaves(const Vec3& in, const Vec3& out) const = 0;
};

std::unique_ptr<Region> ball_region(const Vec3& center, double radius);
/// Flat ends.
std::unique_ptr<Region> cylinder_region(const Vec3& from, const Vec3& to, double radius);
/// What a closed surface holds, whose triangles run anticlockwise as seen from outside or inside.
std::unique_ptr<Region> surface_region(std::vector<Vec3> vertices,
                                       std::vector<std::array<uint32_t, 3>> triangles);
/// Why triangles are no closed surface: the first edge that does not have exactly two, in words; nothing
/// where they are one. `triangle`: one of those at fault.
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
/// `spacing`: m, of the cubic lattice, twice over. Empty where the region is finer than that.
Stuffing stuff(const Region& region, double spacing);
/// About as many nodes and tetrahedra as that makes.
struct StuffingSize {
  double nodes, tetrahedra;
};
StuffingSize stuffing_size(double volume, double spacing);

/// Least and largest angle between faces (rad).
std::array<double, 2> dihedral_angles(std::span<const Vec3> x,
                                      std::span<const std::array<uint32_t, 4>> tetrahedra);

}  // namespace truestep
