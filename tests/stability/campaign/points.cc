// Points and springs: ropes and cloths of any stiffness, free nets, emitters, and the effects of couplings.
#include <cmath>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

constexpr Vec3 kDown{0, -9.81, 0};

json::object cloth_grid(Dice& d, int most) {
  const double side = d.between(0.5, 2);
  return {{"origin", vec(-0.5 * side, 1, -0.5 * side)},
          {"edge_u", vec(side, 0, 0)},
          {"edge_v", vec(0, 0, side)},
          {"nx", d.whole(4, most)},
          {"ny", d.whole(4, most)}};
}

}  // namespace

void rope(Dice& d, Trial& t) {
  const double k = d.spread(10, 1e12), dt = usual_dt(d);
  const Vec3 along = d.direction() * d.between(0.3, 3);
  set_scene(
      t, dt, 1.5, kDown,
      {{{"type", "mass_spring"},
        {"rope",
         json::object{{"from", vec(0, 1)}, {"to", vec(Vec3{0, 1, 0} + along)}, {"links", d.whole(1, 30)}}},
        {"stiffness", k},
        {"mass", d.spread(1e-3, 0.1)},
        {"pinned", json::array{d.of({"first", "first", "ends"})}}}});
  json::object& s = system_of(t);
  if (d.chance(0.3)) s["damping"] = d.spread(1e-4, 0.1);
  if (d.chance(0.2)) s["internal_damping"] = d.spread(1e-3, 10);
  if (d.chance(0.2)) s["bending_stiffness"] = k * d.spread(1e-4, 0.1);
  t.rules.gain = 0.02, t.rules.event = Rules::Event::allowed;
}

void cloth(Dice& d, Trial& t) {
  const double k = d.spread(10, 1e10), dt = usual_dt(d);
  set_scene(t, dt, 1, kDown,
            {{{"type", "mass_spring"},
              {"cloth_grid", cloth_grid(d, 9)},
              {"stiffness", k},
              {"shear_stiffness", k * d.between(0, 1)},
              {"bending_stiffness", k * d.of({0.0, 1e-3, 1e-2})},
              {"mass", d.spread(1e-3, 0.1)}}});
  json::object& s = system_of(t);
  if (d.chance(0.6)) s["pinned"] = json::array{d.of({"corners", "corner_00", "edge_u0"})};
  if (d.chance(0.5)) {
    s["thickness"] = 0.02;
    s["colliders"] = json::array{{{"type", "sphere"},
                                  {"center", vec(0, 0.6)},
                                  {"radius", 0.3},
                                  {"restitution", d.of({0.0, 0.5, 1.0})}},
                                 {{"type", "plane"}, {"point", vec(0, 0)}, {"friction", d.between(0, 1)}}};
  }
  if (d.chance(0.3)) s["internal_damping"] = d.spread(1e-3, 1);
  t.rules.gain = 0.02, t.rules.event = Rules::Event::allowed;
}

void net(Dice& d, Trial& t) {
  const int n = d.whole(3, 12);
  const double k = d.spread(1, 1e6), dt = usual_dt(d), speed = d.spread(0.1, 5);
  json::array points, velocities, masses, springs;
  for (int i = 0; i < n; ++i) {
    points.push_back(vec(d.in_cube(1))), velocities.push_back(vec(d.in_cube(speed)));
    masses.push_back(d.spread(0.1, 10));
  }
  for (int i = 1; i < n; ++i) {
    springs.push_back(json::object{{"a", d.whole(0, i - 1)}, {"b", i}});
    if (i > 1 && d.chance(0.5))
      springs.push_back(json::object{{"a", i - 2}, {"b", i}, {"stiffness", d.spread(0.1, 1) * k}});
  }
  set_scene(t, dt, 2, {},
            {{{"type", "mass_spring"},
              {"free",
               json::object{
                   {"points", points}, {"velocities", velocities}, {"masses", masses}, {"springs", springs}}},
              {"stiffness", k}}});
  t.rules.gain = 0.05, t.rules.event = Rules::Event::allowed;
  t.rules.momentum = 1e-6 * n * 10 * speed;
}

void emitter(Dice& d, Trial& t) {
  const double speed = d.between(0, 20), extra = d.between(0, 0.5) * speed, seconds = 1.5, dt = usual_dt(d);
  const double rate = d.spread(10, 500), mass = d.spread(1e-3, 1), height = d.between(0.5, 5);
  json::object source{{"shape", d.of({"point", "disk", "box", "sphere", "line"})},
                      {"position", vec(0, height)},
                      {"end", vec(1, height)},
                      {"radius", 0.2},
                      {"half_extents", vec(0.2, 0.2, 0.2)},
                      {"direction", vec(d.direction())},
                      {"rate", rate},
                      {"speed", speed},
                      {"speed_spread", extra},
                      {"cone", d.between(0, 1.5)}};
  if (d.chance(0.5)) source["lifetime"] = d.between(0.2, 2);
  json::object system{{"type", "particles"},
                      {"mass", mass},
                      {"radius", 0.02},
                      {"emitters", json::array{source}},
                      {"colliders", json::array{{{"type", "plane"},
                                                 {"point", vec(0, 0)},
                                                 {"restitution", d.between(0, 1)},
                                                 {"friction", d.between(0, 1)}}}}};
  if (d.chance(0.3)) system["linear_drag"] = d.spread(1e-4, 1) * mass;
  if (d.chance(0.2)) system["quadratic_drag"] = d.spread(1e-4, 0.1) * mass;
  set_scene(t, dt, seconds, kDown, {std::move(system)});
  // Their energy at birth: initial speed, and the fall from the highest birth place.
  const double v = speed + extra, n = rate * seconds + 2;
  t.rules.gain.reset();
  expect_range(t, "max(energy.kinetic)", 0, 1.01 * n * mass * (0.5 * v * v + 9.81 * (height + 0.3)),
               "what they are born with and what falling gives");
  expect_range(t, "a.emitted", rate * seconds - 2, n, "rate times time");
}

void cloth_and_particles(Dice& d, Trial& t) {
  const double dt = 1.0 / 60, k = d.spread(100, 3000);
  json::object cloth{
      {"type", "mass_spring"}, {"cloth_grid", cloth_grid(d, 12)}, {"mass", d.spread(3e-3, 0.03)},
      {"stiffness", k},        {"shear_stiffness", 0.4 * k},      {"thickness", 0.02},
      {"damping", 0.02},       {"pinned", json::array{"corners"}}};
  json::object balls{{"type", "particles"},
                     {"mass", d.spread(1e-3, 0.02)},
                     {"radius", 0.03},
                     {"fill", json::array{{{"count", d.whole(1, 20)},
                                           {"arrangement", "random"},
                                           {"center", vec(0, 1.6)},
                                           {"half_extents", vec(0.2, 0.4, 0.2)}}}}};
  set_scene(t, dt, 1.5, kDown, {cloth, balls});
  t.scene["time"].as_object()["substeps"] = 16;
  t.scene["couplings"] = json::array{{{"type", "contact"},
                                      {"id", "hits"},
                                      {"a", "b"},
                                      {"b", "a"},
                                      {"restitution", d.of({0.0, 0.2, 0.8, 1.0})},
                                      {"friction", d.between(0, 1)}}};
  t.rules.gain = 0.02, t.rules.event = Rules::Event::allowed;
}

void attached(Dice& d, Trial& t) {
  const double dt = usual_dt(d), k = d.spread(10, 1e4);
  const auto line = [&](double x) {
    return json::object{
        {"type", "mass_spring"},
        {"rope", json::object{{"from", vec(x, 1)}, {"to", vec(x + 0.8, 1)}, {"links", d.whole(2, 10)}}},
        {"mass", d.spread(0.01, 0.1)},
        {"stiffness", d.spread(10, 1e4)},
        {"velocity", vec(d.in_cube(1))}};
  };
  json::object a = line(0), b = line(1);
  const bool closed = d.chance(0.5);
  if (!closed) a["pinned"] = json::array{"first"};
  set_scene(t, dt, 2, closed ? Vec3{} : kDown, {a, b});
  t.scene["time"].as_object()["substeps"] = d.of({1, 4, 8});
  json::object link{
      {"type", "attachment"},      {"id", "tie"}, {"a", "a"}, {"b", "b"}, {"a_points", json::array{-1}},
      {"b_points", json::array{0}}};
  link["link"] = d.of({"spring", "rigid"});
  if (link["link"] == "spring") link["stiffness"] = k;
  t.scene["couplings"] = json::array{link};
  t.rules.gain = 0.02, t.rules.event = Rules::Event::allowed;
  if (closed) t.rules.momentum = 1e-6;
}

}  // namespace truestep::campaign
