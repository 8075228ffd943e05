// Which balls touch while all bodies move along cubics through the two ends of a piece of their paths.
#pragma once
#include <vector>

#include "engine/base/function_ref.h"
#include "engine/core/state/workspace.h"
#include "engine/kernels/contact/curved_contact.h"

namespace truestep::nbody {

struct Touch {
  double share;  ///< of the piece
  uint32_t a, b;
};

/// Positions and velocities (n x 3; m, m/s) at both ends of a piece that lasts h (s).
struct PathPiece {
  const double *x0, *v0, *x1, *v1;
  size_t n;
  double h;

  /// From a to b.
  CubicPath between(size_t a, size_t b) const {
    const auto apart = [&](const double* p) { return load3(p, b) - load3(p, a); };
    return CubicPath::through(apart(x0), apart(v0) * h, apart(x1), apart(v1) * h);
  }
};

constexpr size_t kEveryPair = 256;  ///< bodies that need no search

/// visit(a, b), a < b, for every pair that may come within its reach (enlarged by `slack` times its way) on
/// the piece, and others; by a search.
void for_near_pairs(const PathPiece& piece, std::span<const double> radius, double slack,
                    Workspace& workspace, FunctionRef<void(uint32_t, uint32_t)> visit);

/// All first touches in order of time, then of rows; those that `skip` names are left out. `slack` is added
/// to every reach, in parts of the pair's way: where the paths are not the cubics themselves.
void find_touches(const PathPiece& piece, std::span<const double> radius, double slack,
                  FunctionRef<bool(uint32_t, uint32_t)> skip, Workspace& workspace, std::vector<Touch>& out);

}  // namespace truestep::nbody
