// Initial positions of a liquid's particles.
#include <algorithm>
#include <cmath>

#include "engine/math/trig.h"
#include "engine/systems/grid_fluid/solids.h"

namespace truestep::grid_fluid {

std::vector<StartingPlace> starting_places(const GridFluidDef& d, std::span<const ObstacleDef> obstacles) {
  const mac::MacGrid g = make_grid(d);
  const auto per = static_cast<size_t>(d.particles_per_axis);
  std::vector<StartingPlace> out;
  std::vector<ObstacleDef> shapes;
  for (const LiquidBodyDef& b : d.bodies)
    shapes.push_back({.shape = b.shape, .center = b.center, .radius = b.radius, .half = b.half});
  const auto place = [&](size_t a, size_t i) {
    return a < g.dimensions
               ? g.origin[a] + g.spacing[a] * (static_cast<double>(i) + 0.5) / static_cast<double>(per)
               : g.origin[a];
  };
  for (size_t k = 0; k < (g.dimensions == 3 ? per * g.cells[2] : 1); ++k) {
    for (size_t j = 0; j < per * g.cells[1]; ++j) {
      for (size_t i = 0; i < per * g.cells[0]; ++i) {
        const Vec3 at{place(0, i), place(1, j), place(2, k)};
        size_t body = 0;
        while (body < shapes.size() && distance_to({&shapes[body], 1}, at, g.dimensions) > 0) ++body;
        if (body == shapes.size() || distance_to(obstacles, at, g.dimensions) <= 0) continue;
        out.push_back({at, body});
      }
    }
  }
  return out;
}

double expected_particles(const GridFluidDef& d) {
  const mac::MacGrid g = make_grid(d);
  constexpr double kPi = 3.14159265358979323846;
  double volume = 0, all = 1;
  for (size_t a = 0; a < g.dimensions; ++a) all *= g.extent(a);
  for (const LiquidBodyDef& b : d.bodies) {
    const bool plane = g.dimensions == 2;
    const double r = b.radius;
    if (b.shape == ObstacleDef::Shape::sphere) {
      volume += plane ? kPi * r * r : 4 * kPi / 3 * r * r * r;
      continue;
    }
    // The part of a box inside the grid.
    const double center[] = {b.center.x, b.center.y, b.center.z}, half[] = {b.half.x, b.half.y, b.half.z};
    double part = 1;
    for (size_t a = 0; a < g.dimensions; ++a) {
      const double low = std::max(center[a] - half[a], g.origin[a]);
      part *= std::max(0.0, std::min(center[a] + half[a], g.origin[a] + g.extent(a)) - low);
    }
    volume += part;
  }
  return std::min(volume, all) / g.cell_volume() *
         trig::pow(static_cast<double>(d.particles_per_axis), static_cast<double>(g.dimensions));
}

}  // namespace truestep::grid_fluid
