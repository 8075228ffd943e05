// Bodies of the material point method that fly, spin and hit each other far from the walls, without gravity:
// every material, transfer, spline, dimension, precision and integration keeps momentum.
#include <algorithm>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {

void closed_materials(Dice& d, Trial& t) {
  const bool space = d.chance(0.4), doubles = d.chance(0.5);
  const double side = space ? 3 : 4, mid = 0.5 * side, speed = d.spread(0.1, 10);
  const int count = d.whole(1, 3);
  bool solid = true;
  json::array bodies;
  for (int i = 0; i < count; ++i) {
    const std::string material =
        d.of({"fluid", "corotated", "neo_hookean", "corotated", "neo_hookean", "snow", "sand", "foam"});
    solid = solid && (material == "corotated" || material == "neo_hookean");
    Vec3 v = d.in_cube(speed);
    if (!space) v.z = 0;
    json::object b{
        {"material", material},
        {"center", vec(mid + 0.6 * (i - 0.5 * (count - 1)), mid + d.between(-0.2, 0.2), space ? mid : 0)},
        {"density", d.spread(100, 3000)},
        {"velocity", vec(v)}};
    if (d.chance(0.5)) {
      b["shape"] = "box";
      b["half_extents"] = vec(d.between(0.1, 0.25), d.between(0.1, 0.25), d.between(0.1, 0.25));
    } else {
      b["shape"] = "ball", b["radius"] = d.between(0.1, 0.25);
    }
    b[material == "fluid" ? "bulk_modulus" : "youngs_modulus"] = d.spread(1e4, 1e6);
    if (material != "fluid") b["poisson_ratio"] = d.of({0.2, 0.3, 0.4});
    if (d.chance(0.4)) b["spin"] = vec(0, 0, d.between(-10, 10));
    if (d.chance(0.2)) b["velocity_field"] = i;
    bodies.push_back(std::move(b));
  }
  json::object s{{"type", "mpm"},
                 {"dimension", space ? 3 : 2},
                 {"low", vec(0, 0, 0)},
                 {"high", vec(side, side, side)},
                 {"cell", d.of({0.05, 0.1})},
                 {"bodies", std::move(bodies)},
                 {"precision", doubles ? "f64" : "f32"},
                 {"transfer", d.of({"apic", "flip"})},
                 {"splines", d.of({"quadratic", "cubic"})}};
  if (s["transfer"] == "flip") s["flip"] = d.of({0.0, 0.5, 0.95, 1.0});
  const bool implicit = doubles && solid && d.chance(0.5);
  if (implicit) s["integration"] = "implicit";
  set_scene(t, d.of({1.0 / 60, 1.0 / 240}), std::min(0.5, 0.5 / speed), {}, {std::move(s)});
  t.rules.gain.reset();
  // Of the largest momentum that the mass has at its kinetic energy; an implicit step ends where its
  // iteration does.
  const double bound = !doubles ? 1e-4 : implicit ? 1e-5 : 1e-9;
  for (const char* axis : {"x", "y", "z"}) {
    expect_range(t, std::string("change(a.momentum.") + axis + ") / sqrt(2*max(a.mass)*max(energy.kinetic))",
                 0, bound, "nothing acts from outside");
  }
}

}  // namespace truestep::campaign
