// Chains and trees in reduced coordinates, and equations: rod chains, articulations, linkages, pendulums,
// balls that bounce by events.
#include <cmath>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

constexpr Vec3 kDown{0, -9.81, 0};

}  // namespace

void rod_chain(Dice& d, Trial& t) {
  const double dt = usual_dt(d);
  json::object chain{{"type", "rod_chain"},
                     {"links", d.whole(1, 12)},
                     {"length", d.spread(0.1, 1)},
                     {"mass", d.spread(0.05, 10)},
                     {"direction", vec(d.direction())}};
  if (d.chance(0.3)) chain = {{"type", "rod_chain"}};
  if (d.chance(0.5)) chain["constraints"] = d.of({"projection", "penalty"});
  set_scene(t, dt, 4, kDown, {chain});
  // RK4 of a wild swing in steps of 1/60 s. Joint springs too stiff for such a step are reported by an event.
  t.rules.gain = 0.05;
  const json::value* how = chain.if_contains("constraints");
  if (how && *how == "penalty") t.rules.event = Rules::Event::allowed;
}

void articulation(Dice& d, Trial& t) {
  const int n = d.whole(1, 8);
  const double dt = usual_dt(d), length = d.between(0.1, 0.6);
  json::array links;
  for (int i = 0; i < n; ++i) {
    const std::string joint = d.of({"hinge", "hinge", "ball", "universal", "slider"});
    json::object l{{"joint", joint},
                   {"offset", i == 0 ? vec(0, 0) : vec(length, 0)},
                   {"shapes", json::array{{{"type", "box"},
                                           {"half_extents", vec(0.5 * length, 0.05, 0.08)},
                                           {"position", vec(0.5 * length, 0)}}}},
                   {"density", d.spread(100, 5000)}};
    if (joint == "hinge") l["axis"] = d.chance(0.5) ? vec(0, 0, 1) : vec(0, 1, 0);
    if (joint == "universal") l["axis"] = vec(0, 0, 1), l["second_axis"] = vec(0, 1, 0);
    // A slider falls forever unless a spring holds it.
    if (joint == "slider") l["axis"] = vec(0, 1, 0);
    if (joint == "slider" || d.chance(0.6)) l["stiffness"] = d.spread(1, 1e7);
    if (d.chance(0.4)) l["damping"] = d.spread(1e-3, 100);
    links.push_back(l);
  }
  set_scene(t, dt, 2, kDown, {{{"type", "articulation"}, {"links", links}}});
  t.rules.gain = 0.02;
}

void linkage(Dice& d, Trial& t) {
  // Crank, coupler and rocker of any lengths that form a closed loop: the ground bar from (0, 0) to (g, 0).
  const double crank = d.between(0.2, 0.6), g = d.between(0.8, 1.2), angle = d.between(0, 6.28);
  const Vec3 tip{crank * std::cos(angle), crank * std::sin(angle), 0}, other{g, d.between(0.6, 1.4), 0};
  const Vec3 coupler = other - tip, rocker = other - Vec3{g, 0, 0};
  const auto bar = [&](const char* id, const char* parent, const json::array& offset, const Vec3& end) {
    return json::object{{"id", id},
                        {"parent", parent},
                        {"offset", offset},
                        {"mass", d.spread(0.3, 3)},
                        {"center", vec(end * 0.5)},
                        {"inertia", json::array{0.02, 0.02, 0.02}}};
  };
  json::array links{bar("crank", "ground", vec(0, 0), tip), bar("coupler", "crank", vec(tip), coupler),
                    bar("rocker", "ground", vec(g, 0), rocker)};
  const double dt = usual_dt(d);
  set_scene(
      t, dt, 4, kDown,
      {{{"type", "articulation"},
        {"links", links},
        {"closures",
         json::array{
             {{"a", "coupler"}, {"b", "rocker"}, {"point_a", vec(coupler)}, {"point_b", vec(rocker)}}}}}});
  const bool exact = d.chance(0.5);
  if (exact) system_of(t)["integrator"] = "dop853", system_of(t)["tolerance"] = 1e-10;
  t.rules.gain = exact ? 1e-4 : 0.02, t.rules.loss = exact ? 1e-4 : 0.1;
}

void pendulum(Dice& d, Trial& t) {
  const int n = d.whole(1, 6);
  json::array lengths, masses, angles;
  for (int i = 0; i < n; ++i) {
    lengths.push_back(d.between(0.3, 1.5)), masses.push_back(d.spread(0.3, 3));
    angles.push_back(d.between(-3, 3));
  }
  set_scene(
      t, usual_dt(d), 3, kDown,
      {{{"type", "pendulum"}, {"links", n}, {"lengths", lengths}, {"masses", masses}, {"angles", angles}}});
  // RK4 in steps of 1/60 s through the fastest flips of several links.
  t.rules.gain = 0.05;
}

void bounces(Dice& d, Trial& t) {
  const double h = d.between(0.1, 2), e = d.between(0.2, 0.9), g = d.between(1, 20);
  // All bounces are over after sqrt(2 h / g) (1 + e) / (1 - e).
  const double end = std::sqrt(2 * h / g) * (1 + e) / (1 - e), dt = usual_dt(d);
  json::object ball{{"type", "ode"},
                    {"states", json::object{{"h", h}, {"v", 0}}},
                    {"parameters", json::object{{"g", g}, {"e", e}}},
                    {"equations", json::object{{"h", "v"}, {"v", "-g"}}},
                    {"events", json::array{{{"name", "bounce"},
                                            {"when", "h"},
                                            {"direction", "falling"},
                                            {"set", json::object{{"v", "-e * v"}}}}}}};
  set_scene(t, dt, dt * std::ceil(std::min(1.5 * end + 0.5, 12.0) / dt), {}, {ball});
  expect_range(t, "min(a.h)", -1e-3, 1e9, "the floor holds");
  t.rules.event = Rules::Event::allowed;
}

}  // namespace truestep::campaign
