// A flow in the plane by its stream function psi on the nodes of the staggered grid, u = dpsi/dy, v =
// -dpsi/dx, which has no divergence whatever psi is, and the curl of accelerations on the same nodes, which
// no pressure changes: what is left of the momentum equation is d(vorticity)/dt = curl(rate). Node (i, j) is
// the lower left corner of cell (i, j) and has its offset. Differences of second order, or of fourth
// (fourth_order.h) with sides that hold the fluid or let it slide: values beyond a side that holds it lie on
// polynomials of fourth degree through the side's own velocity and values inside.
#pragma once
#include "engine/kernels/mac/momentum.h"

namespace truestep::mac {

/// What a side does to the fluid beside it, and how fast it moves along itself (m/s).
struct Edge {
  enum class Kind : uint8_t { hold, slide } kind = Kind::hold;
  double velocity = 0;
};
/// [axis][end]
using Edges = std::array<std::array<Edge, 2>, 2>;

/// Velocity on all faces of the box (m/s) from psi (m^2/s) on its nodes.
void velocity_of_stream(const MacGrid& grid, const double* psi, const Fields& u, const ThreadArena& arena);
/// The same of fourth order; psi is 0 on all sides and is continued beyond them, faces on sides become 0.
void velocity_of_stream4(const MacGrid& grid, const Edges& edges, double* psi, const Fields& u,
                         const ThreadArena& arena);
/// Values beyond the sides for component c.
void fill_ghosts4(const MacGrid& grid, size_t c, const Edges& edges, double* u);
/// out = d rate_y / dx - d rate_x / dy on the nodes that lie on no side (1/s^2).
void curl_of_rate(const MacGrid& grid, const ConstFields& rate, double* out, const ThreadArena& arena);
void curl_of_rate4(const MacGrid& grid, const ConstFields& rate, double* out, const ThreadArena& arena);

}  // namespace truestep::mac
