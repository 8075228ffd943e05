// What cells have room for, cell by cell, against its definition: particles spread from every place outside
// the obstacles.
#include "engine/systems/grid_fluid/liquid/room.h"

#include <gtest/gtest.h>

#include "engine/kernels/mac/particles.h"
#include "engine/kernels/mac/surface.h"

namespace truestep::grid_fluid {
namespace {

template <size_t D>
std::vector<double> spread_everywhere(const mac::MacGrid& g, size_t per,
                                      const std::vector<ObstacleDef>& obstacles) {
  std::vector<double> room(g.size());
  const auto place = [per](size_t i) { return (double(i) + 0.5) / double(per); };
  for (size_t k = 0; k < (D == 3 ? per * g.cells[2] : 1); ++k) {
    for (size_t j = 0; j < per * g.cells[1]; ++j) {
      for (size_t i = 0; i < per * g.cells[0]; ++i) {
        const double x[] = {place(i), place(j), place(k)};
        const Vec3 at{g.origin[0] + g.spacing[0] * x[0], g.origin[1] + g.spacing[1] * x[1],
                      D == 3 ? g.origin[2] + g.spacing[2] * x[2] : 0};
        if (distance_to(obstacles, at, D) > 0)
          mac::scatter<D>(g, mac::around_particle<D>(g, mac::kCentre, x), room.data());
      }
    }
  }
  mac::fold_cells(g, room.data(), ThreadArena(1));
  return room;
}

TEST(LiquidRoom, IsThatOfParticlesEverywhereOutsideObstacles) {
  for (const size_t dimensions : {2, 3}) {
    for (const bool periodic : {false, true}) {
      for (const size_t per : {1, 2, 3, 4}) {
        mac::MacGrid g;
        g.dimensions = dimensions, g.cells = {12, 10, dimensions == 3 ? size_t{9} : 1};
        g.spacing = {0.1, 0.1, 0.1}, g.origin = {-0.2, 0, 0.1};
        g.periodic = {periodic, false, periodic && dimensions == 3};
        std::vector<ObstacleDef> obstacles(2);
        obstacles[0].center = {0.3, 0.5, 0.5}, obstacles[0].radius = 0.17;
        // Across the end of the first axis.
        obstacles[1].shape = ObstacleDef::Shape::box, obstacles[1].half = {0.12, 0.2, 0.3};
        obstacles[1].center = {1.0, 0.2, 0.4};
        Solids solids(obstacles, g);
        Room room;
        const ThreadArena arena(2);
        room.bind(g, per, arena);
        for (const double moved : {0.0, -0.33}) {
          obstacles[0].center.x += moved;
          solids.place(obstacles, g);
          room.measure(solids, obstacles, arena);
          const auto expected = dimensions == 2 ? spread_everywhere<2>(g, per, obstacles)
                                                : spread_everywhere<3>(g, per, obstacles);
          double least = room.whole();
          for (size_t k = 0; k < g.cells[2]; ++k) {
            for (size_t j = 0; j < g.cells[1]; ++j) {
              for (size_t i = 0; i < g.cells[0]; ++i) {
                const size_t at = g.at(i, j, k);
                // Sums of at most 6^3 weights.
                ASSERT_NEAR(room.data()[at], expected[at], 1e-13 * room.whole())
                    << dimensions << "-D, " << per << " per axis, at " << i << " " << j << " " << k;
                least = std::min(least, expected[at]);
              }
            }
          }
          EXPECT_LT(least, 0.5 * room.whole()) << "control: obstacles take room, sides none";
        }
      }
    }
  }
}

}  // namespace
}  // namespace truestep::grid_fluid
