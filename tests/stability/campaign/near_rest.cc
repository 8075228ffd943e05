// Springs and elastic blocks that hardly move, by implicit methods: their speeds are drawn down to the
// rounding of positions, which lie up to a kilometre from the origin. No step may fail, and no energy may be
// gained beyond rounding.
#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {

namespace {

json::object net_of_points(Dice& d, const Vec3& at, double speed) {
  const int n = d.whole(2, 6);
  json::array points, velocities, masses, springs;
  for (int i = 0; i < n; ++i) {
    points.push_back(vec(at + d.in_cube(1))), velocities.push_back(vec(d.in_cube(speed)));
    masses.push_back(d.spread(0.1, 10));
    if (i > 0) springs.push_back(json::object{{"a", d.whole(0, i - 1)}, {"b", i}});
  }
  return {{"type", "mass_spring"},
          {"free",
           json::object{
               {"points", points}, {"velocities", velocities}, {"masses", masses}, {"springs", springs}}},
          {"stiffness", d.spread(1, 1e6)}};
}

json::object sheet(Dice& d, const Vec3& at, double speed) {
  json::object s{{"type", "mass_spring"},
                 {"cloth_grid", json::object{{"origin", vec(at)},
                                             {"edge_u", vec(1, 0, 0)},
                                             {"edge_v", vec(0, 0, 1)},
                                             {"nx", d.whole(2, 6)},
                                             {"ny", d.whole(2, 6)}}},
                 {"mass", d.spread(1e-3, 1)},
                 {"stiffness", d.spread(10, 1e6)},
                 {"velocity", vec(0, speed)}};
  if (d.chance(0.6)) s["pinned"] = json::array{d.of({"corners", "edge_u0"})};
  return s;
}

json::object block(Dice& d, const Vec3& at, double speed) {
  const double side = d.spread(0.1, 10);
  json::object s{
      {"type", "fem"},
      {"youngs_modulus", d.spread(1e4, 3e11)},
      {"poisson_ratio", d.of({0.0, 0.3, 0.45})},
      {"material", d.of({"linear", "corotated", "neo_hookean", "stable_neo_hookean", "mooney_rivlin"})},
      {"density", d.spread(100, 8000)},
      {"velocity", vec(0, speed)}};
  if (d.chance(0.5)) {
    const Vec3 u{side, 0, 0}, v{0, 0.3 * side, 0};
    s["quad"] = json::object{{"corners", json::array{vec(at), vec(at + u), vec(at + u + v), vec(at + v)}},
                             {"cells_x", d.whole(1, 4)},
                             {"cells_y", 1}};
  } else {
    s["block"] = json::object{{"origin", vec(at)},
                              {"size", vec(side, 0.3 * side, 0.3 * side)},
                              {"cells_x", d.whole(1, 4)},
                              {"cells_y", 1},
                              {"cells_z", 1}};
  }
  if (d.chance(0.5)) s["pinned"] = json::array{"x0"};
  return s;
}

}  // namespace

void near_rest(Dice& d, Trial& t) {
  const double speed = d.chance(0.2) ? 0 : d.spread(1e-15, 1e-2), dt = usual_dt(d);
  const double far = d.of({0.0, 1.0, 10.0, 1000.0});
  const Vec3 at{far, far, 0};
  json::object s = d.chance(0.3)   ? block(d, at, speed)
                   : d.chance(0.5) ? net_of_points(d, at, speed)
                                   : sheet(d, at, speed);
  s["integrator"] = d.of({"implicit_euler", "implicit_euler", "implicit_euler", "implicit_midpoint",
                          "trapezoid", "bdf2", "newmark", "generalized_alpha"});
  set_scene(t, dt, 60 * dt, {}, {std::move(s)});
  t.rules.gain.reset();
}

}  // namespace truestep::campaign
