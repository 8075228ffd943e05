// Derivatives dP/dF of the elastic laws in the axes of F's singular values. All laws but the linear one are
// isotropic: with F = U diag(s) V^T and dF = U E V^T, dP/dF splits into a 3 x 3 block for the diagonal of E
// and a 2 x 2 block [on off; off on] for every pair of elements E_pq, E_qp, in closed form (Smith, de Goes,
// Kim 2019, "Analytic eigensystems for isotropic distortion energies"). Definite derivatives are clamped in
// this form, from which an element's stiffness is also cheaper than from the 81 numbers of dP/dF.
#pragma once
#include <array>
#include <span>
#include <utility>

#include "engine/kernels/fem/material.h"
#include "engine/math/svd3.h"

namespace truestep::fem {

/// The pairs of axes, in the order of PrincipalSlope::on and off; 3 - p - q is the third axis.
inline constexpr std::array<std::pair<size_t, size_t>, 3> kPairs{{{0, 1}, {0, 2}, {1, 2}}};

/// theta and its derivatives by the singular values.
struct PrincipalTheta {
  double theta;
  std::array<double, 3> slope;
};
PrincipalTheta principal_theta(const Material& material, const std::array<double, 3>& s);

struct PrincipalSlope {
  std::array<double, 9> stretch{};  ///< symmetric, of E_00, E_11, E_22
  std::array<double, 3> on{}, off{};
};
/// For all laws but the linear one.
PrincipalSlope principal_slope(const Material& material, const std::array<double, 3>& s,
                               const Dilatation& dilatation);
/// Projects to the nearest positive semidefinite form (negative eigenvalues become 0).
void clamp(PrincipalSlope& slope);

/// dP/dF as nine by nine numbers.
Mat9 turned(const PrincipalSlope& slope, const Svd3& svd);

/// Adds weight * grad N_a . dP/dF . grad N_b for all b >= a to the blocks k[9 (a nodes + b)], column by
/// column. `gradients` are at rest and are turned by V^T here.
void add_stiffness(const PrincipalSlope& slope, const Svd3& svd, std::span<const Vec3> gradients,
                   double weight, double* k);

}  // namespace truestep::fem
