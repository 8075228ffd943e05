#include "engine/systems/nbody/collisions/touches.h"

#include <algorithm>

#include "engine/neighbours/point_grid.h"

namespace truestep::nbody {

void for_near_pairs(const PathPiece& piece, std::span<const double> radius, double slack,
                    Workspace& workspace, FunctionRef<void(uint32_t, uint32_t)> visit) {
  double reach = 0, way = 0;
  for (size_t i = 0; i < piece.n; ++i) {
    reach = std::max(reach, radius[i]);
    const auto at = [i](const double* p) { return load3(p, i); };
    way = std::max(
        way, CubicPath::through(at(piece.x1), -at(piece.v1) * piece.h, at(piece.x0), -at(piece.v0) * piece.h)
                 .spread());
  }
  if (!(reach > 0)) return;
  auto& grid = workspace.object<PointGrid>("nbody.grid");
  grid.build({piece.x1, 3 * piece.n}, 2 * reach + (2 + 2 * slack) * way);
  for (size_t slot = 0; slot < grid.size(); ++slot) {
    grid.near(grid.position(slot), [&](uint32_t begin, uint32_t end) {
      for (uint32_t other = begin; other < end; ++other) {
        const uint32_t a = grid.point(slot), b = grid.point(other);
        if (a < b) visit(a, b);
      }
    });
  }
}

void find_touches(const PathPiece& piece, std::span<const double> radius, double slack,
                  FunctionRef<bool(uint32_t, uint32_t)> skip, Workspace& workspace, std::vector<Touch>& out) {
  const size_t n = piece.n;
  out.clear();
  const auto look = [&](uint32_t a, uint32_t b) {
    double reach = radius[a] + radius[b];
    if (!(reach > 0)) return;
    const CubicPath path = piece.between(a, b);
    if (slack > 0) reach += slack * path.spread();
    if (!path.may_reach(reach) || skip(a, b)) return;
    const double share = first_contact_on_cubic(path, reach);
    if (share <= 1) out.push_back({share, a, b});
  };
  if (n <= kEveryPair) {
    for (uint32_t a = 0; a < n; ++a) {
      for (uint32_t b = a + 1; b < n; ++b) look(a, b);
    }
  } else {
    for_near_pairs(piece, radius, slack, workspace, look);
  }
  std::sort(out.begin(), out.end(), [](const Touch& p, const Touch& q) {
    return p.share != q.share ? p.share < q.share : p.a != q.a ? p.a < q.a : p.b < q.b;
  });
}

}  // namespace truestep::nbody
