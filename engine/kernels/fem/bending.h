// Bending of thin sheets of six-noded triangles without rotations: curvatures k_ab = d2x / ds_a ds_b inside
// the triangles, and across their edges an interior penalty that makes the surface smooth (Engel and others
// 2002, Computer Methods in Applied Mechanics and Engineering 191; Brenner, Sung 2005, Journal of Scientific
// Computing 22; for large isometric bending Bonito, Nochetto, Ntogkas 2021):
//   E = D [ sum_T A/2 ((1 - nu) k:k + nu |tr k|^2) - sum_e int M . J ds + sum_e eta / (2 h) int |J|^2 ds ]
// with M = mean of k_mm + nu k_tt over both sides of an edge, J = sum of the slopes dx/dm along the outward
// conormals m of both sides, which is 0 where the surface is smooth, D = E t^3 / (12 (1 - nu^2)). k, M, J are
// vectors in space: E is quadratic in the positions and invariant under rigid motions, and is valid while the
// sheet stretches much less than it bends. For an edge that is bent at rest J - j n replaces J, with n the
// unit normal between its sides. eta is large enough for E to be positive on every mesh: with |M|^2 <= k:C:k
// and three edges per triangle, eta > 3 inside and > 6 at edges with one side (Young's inequality).
#pragma once
#include <array>
#include <span>

#include "engine/math/vec3.h"

namespace truestep::fem {

/// Coefficients of the six nodes (corners, then middles of the edges 01, 12, 20).
using SixNodes = std::array<double, 6>;

/// Curvatures of a flat triangle: k_11, k_22, k_12 (1/m^2) in an orthonormal frame of its plane are sums over
/// its nodes.
struct TriangleCurvature {
  std::array<SixNodes, 3> k;
  double area;  ///< m^2
};
TriangleCurvature triangle_curvature(std::span<const Vec3, 3> corners);
/// Second derivative of the energy at D = 1: [6 a + b], 1/m^2.
std::array<double, 36> triangle_bending(const TriangleCurvature& triangle, double poisson);

/// One of the two quadrature points of an edge: sums over the nodes of the first side, then of the second.
struct EdgePoint {
  using TwelveNodes = std::array<double, 12>;
  double weight;        ///< m
  double penalty;       ///< eta / h, 1/m
  TwelveNodes jump;     ///< J; 1/m
  TwelveNodes moment;   ///< M; 1/m^2
  TwelveNodes along;    ///< dx/ds along the edge; 1/m
  TwelveNodes between;  ///< difference of the slopes along the conormals, 1/m
};
/// The edge from corner `edge` of each side to the next; without a second side (null) it is the rim, clamped
/// in its direction.
std::array<EdgePoint, 2> edge_points(std::span<const Vec3, 3> first, size_t first_edge, const Vec3* second,
                                     size_t second_edge, double poisson);

/// Phi = L . n, n = t x c / |t x c|: the energy term of a bent edge, as a function of its sums L, t, c.
struct Bent {
  double value;
  Vec3 slope[3];  ///< by L, t, c
};
Bent bent(const Vec3& l, const Vec3& t, const Vec3& c);
enum class BentSlope : bool { exact, definite };
/// Second derivative by (L, t, c), [9 row + column]. Definite: with f |dn|^2 instead of L . d2n, which is
/// exact at rest for f = eta j / h.
std::array<double, 81> bent_slope(const Vec3& l, const Vec3& t, const Vec3& c, BentSlope kind, double f);

}  // namespace truestep::fem
