// Stiff elastic blocks and neo-Hookean sheets of constraints at every Poisson's ratio, thrown or held at a
// side, without gravity: their substeps follow from their stiffness, and nothing gives them energy.
#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {

namespace {

constexpr double kDensity = 100, kThickness = 1e-3;

/// `speed`: of sound, in cells a step.
json::object block(Dice& d, double speed, double dt) {
  const int nx = d.whole(1, 4), ny = d.whole(1, 4), nz = d.whole(1, 4);
  const double cell = d.spread(0.01, 1), flat = d.of({1.0, 0.5, 0.25}), sound = speed * cell * flat / dt;
  return {{"block", json::object{{"origin", vec(0, 0, 0)},
                                 {"size", vec(nx * cell, ny * cell * flat, nz * cell)},
                                 {"cells_x", nx},
                                 {"cells_y", ny},
                                 {"cells_z", nz}}},
          {"density", kDensity},
          {"youngs_modulus", kDensity * sound * sound},
          {"pinned", json::array{"bottom"}}};
}

json::object sheet(Dice& d, double speed, double dt) {
  const int nx = d.whole(3, 8), ny = d.whole(3, 8);
  const double cell = d.spread(0.01, 1), flat = d.of({1.0, 0.5, 0.25}), sound = speed * cell * flat / dt;
  const double mass = kDensity * kThickness * cell * cell * flat;
  return {{"cloth_grid", json::object{{"origin", vec(0, 0, 0)},
                                      {"edge_u", vec((nx - 1) * cell, 0, 0)},
                                      {"edge_v", vec(0, 0, (ny - 1) * cell * flat)},
                                      {"nx", nx},
                                      {"ny", ny}}},
          {"mass", mass},
          {"thickness", kThickness},
          {"membrane", "neo_hookean"},
          {"youngs_modulus", kDensity * sound * sound},
          {"pinned", json::array{"edge_u0"}}};
}

}  // namespace

void stiff_elastic(Dice& d, Trial& t) {
  const double dt = d.of({1.0 / 60, 1.0 / 240}), speed = d.spread(1, 40);
  json::object system = d.chance(0.5) ? block(d, speed, dt) : sheet(d, speed, dt);
  if (d.chance(0.5)) system.erase("pinned");
  system["type"] = "xpbd";
  system["poisson_ratio"] = d.of({-0.3, 0.0, 0.1, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45});
  system["velocity"] = vec(d.in_cube(1));
  set_scene(t, dt, 120 * dt, {}, {std::move(system)});
  // Of motion: stretch that a substep has left is no energy that anything was given (drapes.cc).
  t.rules.gain.reset();
  expect_range(t, "max(energy.kinetic) / start(energy.kinetic)", 0, 1.001, "nothing gives it energy");
}

}  // namespace truestep::campaign
