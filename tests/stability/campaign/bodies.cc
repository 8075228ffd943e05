// Points and rigid bodies in space together, at defaults: crates that fall on cloth, crowds that hit tumbling
// boxes, bodies that hang on ropes.
#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

constexpr Vec3 kDown{0, -9.81, 0};

json::object body(Dice& d, const Vec3& at, double mass) {
  const double size = d.between(0.08, 0.25);
  json::object b{{"type", d.of({"box", "sphere", "capsule", "cylinder"})},
                 {"position", vec(at)},
                 {"axis", vec(d.direction())},
                 {"angle", d.between(0, 3)},
                 {"velocity", vec(d.in_cube(1))},
                 {"angular_velocity", vec(d.in_cube(3))},
                 {"mass", mass}};
  if (b["type"] == "box") {
    b["half_extents"] = vec(size, size * d.between(0.4, 1), size * d.between(0.4, 1));
  } else {
    b["radius"] = size;
    if (b["type"] == "capsule" || b["type"] == "cylinder") b["half_length"] = size * d.between(0.5, 1.5);
  }
  return b;
}

/// m by which a body must start higher than half a metre above what it falls on, in any orientation: what
/// starts inside something is pushed out, which adds energy.
double lift(const json::object& b) {
  const bool round = b.contains("half_length");
  return round ? std::max(0.0,
                          b.at("radius").to_number<double>() + b.at("half_length").to_number<double>() - 0.45)
               : 0;
}

json::object bodies(json::array all, Dice& d) {
  return {{"type", "rigid3d"}, {"bodies", std::move(all)}, {"precision", d.of({"f32", "f64"})}};
}

json::object contact(Dice& d) {
  return {{"type", "contact"},
          {"id", "touch"},
          {"a", "a"},
          {"b", "b"},
          {"restitution", d.of({0.0, 0.2, 0.8})},
          {"friction", d.between(0, 1)}};
}

}  // namespace

void cloth_and_bodies(Dice& d, Trial& t) {
  const double k = d.spread(100, 3000), point = d.spread(1e-3, 0.02), side = d.between(1, 2);
  json::object cloth{{"type", "mass_spring"},
                     {"cloth_grid", json::object{{"origin", vec(-0.5 * side, 1, -0.5 * side)},
                                                 {"edge_u", vec(side, 0, 0)},
                                                 {"edge_v", vec(0, 0, side)},
                                                 {"nx", d.whole(5, 14)},
                                                 {"ny", d.whole(5, 14)}}},
                     {"mass", point},
                     {"stiffness", k},
                     {"shear_stiffness", k * d.between(0.2, 1)},
                     {"thickness", d.between(0.01, 0.04)},
                     {"damping", d.of({0.0, 0.01})},
                     {"pinned", json::array{d.of({"corners", "border"})}}};
  json::array fall;
  const int n = d.whole(1, 4);
  double raised = 0;
  for (int i = 0; i < n; ++i) {
    json::object b =
        body(d, Vec3{d.between(-0.2, 0.2), 1.5 + 0.6 * i, d.between(-0.2, 0.2)}, d.spread(0.05, 2));
    if (i == 0) raised = lift(b);
    if (raised > 0) {
      json::value& y = b["position"].as_array()[1];
      y = y.to_number<double>() + raised;
    }
    fall.push_back(std::move(b));
  }
  set_scene(t, 1.0 / 60, 2, kDown, {cloth, bodies(std::move(fall), d)});
  t.scene["couplings"] = json::array{contact(d)};
  t.rules.gain = 0.02;
}

void crowd_and_bodies(Dice& d, Trial& t) {
  json::array places, velocities, masses, tumble;
  const int n = d.whole(2, 40);
  for (int i = 0; i < n; ++i) {
    places.push_back(vec(Vec3{0, 2, 0} + d.in_cube(0.8)));
    velocities.push_back(vec(Vec3{0, -d.between(0, 10), 0} + d.in_cube(1)));
  }
  for (int i = 0; i < 2; ++i) tumble.push_back(body(d, Vec3{0.6 * i - 0.3, 0, 0}, d.spread(0.1, 5)));
  json::object dust{{"type", "particles"},
                    {"mass", d.spread(1e-3, 0.5)},
                    {"radius", d.between(0.01, 0.05)},
                    {"positions", places},
                    {"velocities", velocities}};
  set_scene(t, usual_dt(d), 2, {}, {dust, bodies(std::move(tumble), d)});
  t.scene["couplings"] = json::array{contact(d)};
  t.rules.gain = 0.01;
}

void bodies_on_ropes(Dice& d, Trial& t) {
  const double k = d.spread(1e2, 1e5), length = d.between(0.5, 2);
  json::object rope{
      {"type", "mass_spring"},
      {"rope", json::object{{"from", vec(0, 3)}, {"to", vec(length, 3)}, {"links", d.whole(2, 20)}}},
      {"mass", d.spread(0.005, 0.1)},
      {"stiffness", k},
      {"pinned", json::array{"first"}}};
  json::object hung = body(d, Vec3{length, 3, 0}, d.spread(0.1, 10));
  hung["velocity"] = vec(0, 0, 0);
  set_scene(t, usual_dt(d), 3, kDown, {rope, bodies(json::array{hung}, d)});
  json::object tie{
      {"type", "attachment"},      {"id", "tie"}, {"a", "a"}, {"b", "b"}, {"a_points", json::array{-1}},
      {"b_points", json::array{0}}};
  tie["link"] = d.of({"spring", "rigid"});
  // Seeds from here on have stiff ties, too, and from the second on bodies below the ropes' ends.
  constexpr uint64_t kStiffToo = 10'000'000, kBelowToo = 20'000'000;
  if (tie["link"] == "spring") tie["stiffness"] = d.spread(1e2, t.seed < kStiffToo ? 1e4 : 1e7);
  if (t.seed >= kBelowToo) {
    json::object& lower = system_of(t, 1)["bodies"].as_array()[0].as_object();
    lower["position"] = vec(length + d.between(-0.5, 0.5), 3 - d.between(0.1, 1));
  }
  t.scene["couplings"] = json::array{tie};
  t.rules.gain = 0.02;
}

}  // namespace truestep::campaign
