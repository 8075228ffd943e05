// Elastic materials as energies per undeformed volume of the deformation gradient F, in two parts,
//   psi(F) = psi_shape(F) + U(theta(F)),
// because only the second one makes a nearly incompressible body stiff: an element that uses its mean theta
// there does not lock (Nagtegaal, Parks, Rice 1974; Simo, Taylor, Pister 1985).
//   linear               mu e:e, e = sym(F) - 1;             theta = tr e,       U = lambda/2 theta^2
//   corotated            mu |F - R|^2, F = R S;              theta = tr(S) - 3,  the same U
//   st_venant_kirchhoff  mu E:E, E = (F^T F - 1)/2;          theta = tr E,       the same U
//   neo_hookean          mu/2 (I1 - 3) - mu ln J;            theta = J,          U = lambda/2 ln^2 J
//   stable_neo_hookean   m/2 (I1 - 3) - m/2 ln((I1 + 1)/4);  theta = J,  U = l/2 ((J - a)^2 - (1 - a)^2)
//     m = 4/3 mu, l = lambda + 5/6 mu, a = 1 + 3/4 m/l       (Smith, de Goes, Kim 2018, eq. 14)
//   mooney_rivlin        c1 (I1 - 3) + c2 (I2 - 3) - 2 (c1 + 2 c2) ln J;  theta = J, U = l/2 ln^2 J
//     2 (c1 + c2) = mu, l = lambda - 4 c2                    (Ciarlet 1988, section 4.10)
// All have the Lame moduli mu and lambda at rest. Below J = kFloor, ln J continues as its second-order Taylor
// polynomial, so an inverted element has a finite energy that restores it.
#pragma once
#include <array>
#include <cstdint>

#include "engine/math/mat3.h"

namespace truestep::fem {

enum class Law : uint8_t {
  linear,
  corotated,
  st_venant_kirchhoff,
  neo_hookean,
  stable_neo_hookean,
  mooney_rivlin
};

struct Material {
  Law law = Law::neo_hookean;
  double mu = 1, lambda = 1;  ///< Pa
  double second = 0;          ///< mooney_rivlin: c2 / (c1 + c2)
};
/// From Young's modulus (Pa) and Poisson's ratio.
Material material_of(Law law, double youngs_modulus, double poisson_ratio, double second = 0);

inline constexpr double kFloor = 0.01;  ///< of J, below which the logarithm is replaced

/// Element k of nine, l of nine: d P_k / d F_l at [9 k + l].
using Mat9 = std::array<double, 81>;

struct Response {
  double energy = 0;  ///< psi_shape, Pa
  Mat3 p;             ///< its derivative by F
  double theta = 0;
  Mat3 dtheta;
};
struct Curvature {
  Mat9 shape;  ///< d2 psi_shape / dF2
  Mat9 theta;  ///< d2 theta / dF2
};
/// `curvature` may be null.
void respond(const Material& material, const Mat3& f, Response& out, Curvature* curvature);

/// U, U' and U''.
struct Volumetric {
  double u, du, ddu;
};
Volumetric volumetric(const Material& material, double theta);

/// All of psi, P and dP/dF at one point, theta its own.
struct Stress {
  double energy;
  Mat3 p;
  Mat9 dp;
};
Stress stress(const Material& material, const Mat3& f);

/// The theta at which U is evaluated for a point.
struct Dilatation {
  Volumetric u;
  bool own = true;  ///< pointwise: U'' enters the point's curvature
};

/// dP/dF with U' (and U'' if theta is pointwise) of `dilatation`.
Mat9 slope(const Material& material, const Mat3& f, const Dilatation& dilatation);
/// The nearest positive semidefinite matrix (negative eigenvalues become 0); see principal.h.
Mat9 definite_slope(const Material& material, const Mat3& f, const Dilatation& dilatation);

}  // namespace truestep::fem
