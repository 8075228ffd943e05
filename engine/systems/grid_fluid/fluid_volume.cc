// The volume that obstacles leave to the fluid. Cells that they cut are divided in halves along every axis
// until little is left; the fluid's share of such a piece is 1/2 + distance / width, exact where the wall is
// along the grid.
#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/systems/grid_fluid/solids.h"

namespace truestep::grid_fluid {

namespace {
struct Piece {
  Vec3 middle, half;  ///< m
};

double share_of(std::span<const ObstacleDef> obstacles, size_t dimensions, const Piece& p, int divisions) {
  const double distance = distance_to(obstacles, p.middle, dimensions);
  const double reach = dimensions == 3 ? norm(p.half) : norm(Vec3{p.half.x, p.half.y, 0});
  if (std::abs(distance) >= reach) return distance > 0 ? 1 : 0;
  if (divisions == 0) return std::clamp(0.5 + distance / (2 * std::min(p.half.x, p.half.y)), 0.0, 1.0);
  const size_t corners = size_t{1} << dimensions;
  const Vec3 q = 0.5 * p.half;
  double sum = 0;
  for (size_t corner = 0; corner < corners; ++corner) {
    const Vec3 to{corner & 1 ? q.x : -q.x, corner & 2 ? q.y : -q.y, corner & 4 ? q.z : -q.z};
    const Vec3 middle = dimensions == 3 ? p.middle + to : p.middle + Vec3{to.x, to.y, 0};
    sum += share_of(obstacles, dimensions, {middle, q}, divisions - 1);
  }
  return sum / static_cast<double>(corners);
}
}  // namespace

double fluid_volume(std::span<const ObstacleDef> obstacles, const mac::MacGrid& g) {
  const int divisions = g.dimensions == 3 ? 3 : 5;
  double cells = static_cast<double>(g.cell_count());
  std::vector<uint8_t> seen(obstacles.size() > 1 ? g.size() : 0);
  const Vec3 half{0.5 * g.spacing[0], 0.5 * g.spacing[1], 0.5 * g.spacing[2]};
  for (const ObstacleDef& o : obstacles) {
    const CellRange near = cells_near(o, g, 1);
    for (size_t k = near.first[2]; k < std::min(near.last[2], g.cells[2]); ++k) {
      for (size_t j = near.first[1]; j < std::min(near.last[1], g.cells[1]); ++j) {
        for (size_t i = near.first[0]; i < std::min(near.last[0], g.cells[0]); ++i) {
          const size_t at = g.at(i, j, k);
          if (!seen.empty() && std::exchange(seen[at], uint8_t{1})) continue;
          cells -= 1 - share_of(obstacles, g.dimensions, {g.position(mac::kCentre, at), half}, divisions);
        }
      }
    }
  }
  return cells * g.cell_volume();
}

}  // namespace truestep::grid_fluid
