// Mass, centre and inertia of solids of uniform density. Closed forms where possible; polyhedra by exact
// integrals over the tetrahedra between their triangles and a point inside (Tonon 2004), with s = a + b + c:
//   V = a . (b x c) / 6,   int x = V s / 4,   int x x^T = V (a a^T + b b^T + c c^T + s s^T) / 20
#pragma once
#include <optional>
#include <string>

#include "engine/geometry/solid.h"

namespace truestep {

/// Symmetric 3 x 3 matrix.
struct Symmetric3 {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  constexpr Vec3 operator*(const Vec3& v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
  constexpr Symmetric3& operator+=(const Symmetric3& b) {
    xx += b.xx, yy += b.yy, zz += b.zz, xy += b.xy, xz += b.xz, yz += b.yz;
    return *this;
  }
  friend constexpr Symmetric3 operator*(const Symmetric3& a, double s) {
    return {a.xx * s, a.yy * s, a.zz * s, a.xy * s, a.xz * s, a.yz * s};
  }
};

struct MassProperties {
  double mass = 0;     ///< kg
  Vec3 center;         ///< m, centre of mass in the solid's frame
  Symmetric3 inertia;  ///< kg m^2 about the centre, in the solid's axes
};

/// For a solid of the given density (kg/m^3). Error "no_mass" for planes, height fields and meshes that are
/// not closed or inside out.
MassProperties mass_properties(const Solid& solid, double density);

/// The same body placed in another frame.
MassProperties placed(const MassProperties& body, const Transform& at);
/// Both together as one rigid body.
MassProperties operator+(const MassProperties& a, const MassProperties& b);
/// Inertia (kg m^2) about another point than the centre.
Symmetric3 inertia_about(const MassProperties& body, const Vec3& point);

/// I = R(axes) diag(moments) R(axes)^T, by Jacobi's rotations.
struct PrincipalAxes {
  Vec3 moments;  ///< kg m^2
  Quat axes;     ///< rotates principal axes to the solid's; identity when the matrix is diagonal
};
PrincipalAxes principal_axes(const Symmetric3& inertia);

/// Empty when some distribution of mass has this inertia: no moment below 0 or, as integral (y^2 + z^2) dm <=
/// integral (x^2 + z^2) dm + integral (x^2 + y^2) dm, above the sum of the other two. Otherwise what is
/// wrong, as a sentence.
std::optional<std::string> inertia_fault(const Symmetric3& inertia);

}  // namespace truestep
