#include "engine/systems/grid_fluid/solids.h"

#include <algorithm>
#include <cmath>

namespace truestep::grid_fluid {

double distance_to(std::span<const ObstacleDef> obstacles, const Vec3& at, size_t dimensions) {
  double nearest = 1e300;
  for (const ObstacleDef& o : obstacles) {
    double d[3] = {at.x - o.center.x, at.y - o.center.y, dimensions == 3 ? at.z - o.center.z : 0};
    if (o.shape == ObstacleDef::Shape::sphere) {
      nearest = std::min(nearest, std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) - o.radius);
      continue;
    }
    const double half[3] = {o.half.x, o.half.y, o.half.z};
    double outside = 0, inside = -1e300;
    for (size_t a = 0; a < dimensions; ++a) {
      const double beyond = std::abs(d[a]) - half[a];
      outside += std::max(beyond, 0.0) * std::max(beyond, 0.0);
      inside = std::max(inside, beyond);
    }
    nearest = std::min(nearest, std::sqrt(outside) + std::min(inside, 0.0));
  }
  return nearest;
}

Solids::Solids(const std::vector<ObstacleDef>& obstacles, const mac::MacGrid& g) {
  if (obstacles.empty()) return;
  constexpr int kStrips = 8;
  constexpr double kLeastOpen = 1e-3;
  for (size_t c = 0; c < g.dimensions; ++c) {
    open[c].assign(g.size(), 1), fluid[c].assign(g.size(), 1);
    const size_t u = c == 0 ? 1 : 0, w = c == 2 ? 1 : 2;
    const bool space = g.dimensions == 3;
    const double smallest =
        *std::min_element(g.spacing.begin(), g.spacing.begin() + static_cast<ptrdiff_t>(g.dimensions));
    for (size_t k = 0; k < g.count(c, 2); ++k) {
      for (size_t j = 0; j < g.count(c, 1); ++j) {
        for (size_t i = 0; i < g.count(c, 0); ++i) {
          const size_t index[] = {i, j, k};
          double middle[3];
          for (size_t a = 0; a < 3; ++a) middle[a] = g.coordinate(c, a, static_cast<double>(index[a]));
          const auto distance = [&](double along_u, double along_w) {
            double p[3] = {middle[0], middle[1], middle[2]};
            p[u] += along_u * g.spacing[u];
            if (space) p[w] += along_w * g.spacing[w];
            return distance_to(obstacles, {p[0], p[1], p[2]}, g.dimensions);
          };
          const double here = distance(0, 0);
          const size_t at = g.at(i, j, k);
          fluid[c][at] = std::clamp(0.5 + here / smallest, 0.0, 1.0);
          // Share of each strip across the face on which the distance, linear between its ends, is positive.
          double sum = 0;
          const int strips = space ? kStrips : 1;
          for (int s = 0; s < strips; ++s) {
            const double across = (s + 0.5) / strips - 0.5;
            const double low = distance(-0.5, across), high = distance(0.5, across);
            const double length = std::abs(low) + std::abs(high);
            sum += low > 0 && high > 0 ? 1 : low <= 0 && high <= 0 ? 0 : std::max(low, high) / length;
          }
          open[c][at] = sum / strips < kLeastOpen ? 0 : sum / strips;
        }
      }
    }
    for (size_t a = 0; a < g.dimensions; ++a) {
      if (!g.periodic[a] || a != c) continue;
      // Face n of a periodic axis is face 0.
      for (size_t k = 0; k < g.cells[2]; ++k) {
        for (size_t j = 0; j < g.cells[1]; ++j) {
          for (size_t i = 0; i < g.cells[0]; ++i) {
            const size_t index[] = {i, j, k};
            if (index[a] != 0) continue;
            const size_t at = g.at(i, j, k), twin = at + g.cells[a] * g.stride(a);
            open[c][twin] = open[c][at], fluid[c][twin] = fluid[c][at];
          }
        }
      }
    }
  }
}

}  // namespace truestep::grid_fluid
