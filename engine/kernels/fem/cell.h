// Energy, forces and stiffness of one element: with F_q = sum_a x_a (x) grad N_a at the points q of its rule,
//   E = sum_q w_q psi(F_q),   f_a = -sum_q w_q P(F_q) grad N_a,
//   K_ab = sum_q w_q grad N_a . dP/dF . grad N_b
// (Belytschko, Liu, Moran 2000, sections 4.9 and 6.4). With `mean_volume` U is evaluated at the element's
// mean of theta: E = sum_q w_q psi_shape(F_q) + V U(mean theta), the mixed element with constant, condensed
// pressure and dilatation (Simo, Taylor, Pister 1985): Q1-P0, Q2-P0, P2-P0. Plane bodies have F_zz = 1, or in
// plane stress the F_zz for which P_zz = 0, found at every point. With incompatible modes F = sum_a x_a (x)
// grad N_a + sum_k alpha_k (x) G_k, where alpha belongs to the element and minimises E: bending that a
// first-order element cannot represent is then free of shear (Wilson, Taylor, Doherty, Ghaboussi 1973; G of
// Taylor, Beresford, Wilson 1976, which passes the patch test; Simo, Rifai 1990). Forces are evaluated at
// that alpha, the stiffness is condensed.
#pragma once
#include <cstddef>
#include <span>

#include "engine/kernels/fem/material.h"

namespace truestep::fem {

inline constexpr size_t kMostNodes = 27, kMostPoints = 27;

/// Membrane: a sheet in space with gradients by coordinates in its own plane (z is 0) and no stress across
/// it.
enum class Across : uint8_t { space, plane_strain, plane_stress, membrane };
struct CellRule {
  size_t nodes, points;
  const Vec3* gradients;  ///< 1/m, [point * nodes + a]
  const double* weights;  ///< m^3
  Across across = Across::space;
  bool mean_volume = false;
  size_t modes = 0;
  const Vec3* mode_gradients = nullptr;  ///< 1/m, G at [point * modes + k]
};
inline constexpr size_t kMostModes = 3;

/// F of a point; in plane stress F_zz follows from the material. For a membrane, in its own plane with the
/// first axis along the image of x.
Mat3 deformation(const Material& material, const CellRule& rule, const Vec3* x, size_t point);

/// Adds -dE/dx_a (N) to `forces` unless null; returns E (J).
double cell_forces(const Material& material, const CellRule& rule, const Vec3* x, Vec3* forces);

enum class Definite : uint8_t { no, yes };
/// d2E / dx_a dx_b (N/m) as 3 x 3 blocks, column by column, at k[9 (a nodes + b)]; overwritten. Definite:
/// with the derivative at every point made positive semidefinite.
void cell_stiffness(const Material& material, const CellRule& rule, const Vec3* x, Definite definite,
                    double* k);

/// Adds the force on node a (N) and d2E / dx_a2 (N/m, column by column), with the derivative at every point
/// made positive semidefinite: the response to a move of that node alone. In space, with pointwise theta.
void cell_node(const Material& material, const CellRule& rule, const Vec3* x, size_t a, Vec3& force,
               double* k);

}  // namespace truestep::fem
