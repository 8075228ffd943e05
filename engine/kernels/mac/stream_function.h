// A flow in the plane by its stream function psi on the nodes of the staggered grid, u = dpsi/dy, v =
// -dpsi/dx, which is divergence-free for any psi, and the curl of accelerations on the same nodes, which
// pressure does not affect: the momentum equation reduces to d(vorticity)/dt = curl(rate). Node (i, j) is the
// lower left corner of cell (i, j) and has its offset. Differences of second order, or of fourth
// (fourth_order.h) with no-slip or slip sides: values beyond a no-slip side are extrapolated by polynomials
// of fourth degree through the side's own velocity and values inside.
#pragma once
#include "engine/kernels/mac/momentum.h"

namespace truestep::mac {

/// A side's condition on the fluid, and its velocity along itself (m/s).
struct Edge {
  enum class Kind : uint8_t { hold, slide } kind = Kind::hold;
  double velocity = 0;
};
/// [axis][end]
using Edges = std::array<std::array<Edge, 2>, 2>;

/// Velocity on all faces of the box (m/s) from psi (m^2/s) at its nodes.
void velocity_of_stream(const MacGrid& grid, const double* psi, const Fields& u, const ThreadArena& arena);
/// The same of fourth order; psi is 0 on all sides and extrapolated beyond them, faces on sides become 0.
void velocity_of_stream4(const MacGrid& grid, const Edges& edges, double* psi, const Fields& u,
                         const ThreadArena& arena);
/// Fills component c beyond the sides.
void fill_ghosts4(const MacGrid& grid, size_t c, const Edges& edges, double* u);
/// out = d rate_y / dx - d rate_x / dy at the nodes not on a side (1/s^2).
void curl_of_rate(const MacGrid& grid, const ConstFields& rate, double* out, const ThreadArena& arena);
void curl_of_rate4(const MacGrid& grid, const ConstFields& rate, double* out, const ThreadArena& arena);

}  // namespace truestep::mac
