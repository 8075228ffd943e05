// Points and constraints of a shape, as the solver uses them. A stiffness is its family's value, which a
// command may change, times the constraint's own factor.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/drawing.h"
#include "engine/math/mat3.h"
#include "engine/systems/xpbd/xpbd_def.h"

namespace truestep::xpbd {

/// Rows of the column `stiffness`: links in N/m (Pa if Young's modulus is given), bends in N m^2 or N m,
/// volumes in Pa (Young's modulus for an elastic block).
enum class Family : uint8_t { structural, shear, bending, volume };
inline constexpr size_t kFamilies = 4;
inline double stiffness_of(std::span<const double> column, Family family) {
  return column[static_cast<size_t>(family)];
}

struct Link {
  uint32_t a, b;
  Family family;
  double rest;    ///< m
  double factor;  ///< stiffness over that of the family
};

/// K x of N points (kernels/xpbd/linear.h), alpha = 1 / (bending stiffness times factor).
template <size_t N>
struct LinearBend {
  std::array<uint32_t, N> points;
  std::array<double, N> k;
  double factor;
};

struct AngleBend {
  std::array<uint32_t, 4> points;
  double rest;  ///< rad
  double factor;
};

struct Tetrahedron {
  std::array<uint32_t, 4> points;
  double rest;   ///< m^3; alpha = rest / bulk modulus
  Mat3 inverse;  ///< 1/m, of the matrix of rest edges from the first point, as columns
};

/// A triangle of a membrane.
struct SheetTriangle {
  std::array<uint32_t, 3> points;
  double volume;                  ///< m^3, rest area times thickness
  std::array<double, 4> inverse;  ///< 1/m, of the in-plane rest edges from the first point, row by row
};

struct Body {
  std::vector<Vec3> x;           ///< m
  size_t capacity = 0;           ///< most rows there can be: points, and those that tearing adds
  std::vector<double> masses;    ///< kg
  std::vector<Vec3> velocities;  ///< m/s, initial velocities of copies, added to the common one; or empty
  std::vector<Link> links;
  std::vector<LinearBend<3>> rods;
  std::vector<LinearBend<4>> hinges;
  std::vector<AngleBend> angles;
  std::vector<Tetrahedron> tetrahedra;
  std::vector<SheetTriangle> sheet;
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<uint32_t> pins;  ///< ascending, each once
  std::array<double, kFamilies> stiffness{};
};

/// F of a triangle at positions x, column by column.
std::array<Vec3, 2> deformation(const SheetTriangle& t, const double* x);
/// `down` is the direction in which a slack rope sags.
Body build_body(const XpbdDef& def, const Vec3& down);

}  // namespace truestep::xpbd
