// Two fluids in a box, at rest or with waves on their border, from a tenth of a cell to several cells high:
// what moves comes from what has sunk.
#include <cstdio>
#include <numbers>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {

void fluid_layers(Dice& d, Trial& t) {
  const int cells = d.of({16, 32, 48});
  const double side = d.of({0.5, 1.0, 2.0}), level = side * d.between(0.3, 0.7);
  const double height = side * d.of({0.0, 0.005, 0.02, 0.05}), k = std::numbers::pi / side * d.whole(1, 2);
  const double light = d.of({1.0, 1000.0}), heavy = light * d.of({1000.0, 10.0, 2.0, 1.2});
  char where[96];
  std::snprintf(where, sizeof where, "y < %.6g + %.6g*cos(%.6g*x)", level, height, k);
  set_scene(t, d.of({1.0 / 30, 1.0 / 60, 1.0 / 120}), 1.5, {0, -9.81, 0},
            {{{"type", "grid_fluid"},
              {"cells", json::array{cells, cells}},
              {"size", json::array{side, side}},
              {"density", light},
              {"second_fluid",
               json::object{{"where", where}, {"density", heavy}, {"viscosity", d.of({0.0, 1e-5})}}}}});
  t.rules.gain.reset();
  // A border of no wave moves by what the grid does to it: a hundred-thousandth of the weight times the side.
  const double little = 1e-5 * 9.81 * heavy * side * side * side;
  char quantity[320];
  std::snprintf(quantity, sizeof quantity,
                "(max(a.energy.kinetic + a.energy.gravity) - start(a.energy.kinetic + a.energy.gravity)) / "
                "(start(a.energy.gravity) - min(a.energy.gravity) + %.6g)",
                little);
  expect_range(t, quantity, -1, 0.05, "nothing works on the fluids");
}

}  // namespace truestep::campaign
