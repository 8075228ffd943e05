// Bodies that attract each other and collide, by every kind of method: a few that bounce without loss keep
// their energy (to a hundredth of what a pair in contact holds); two that fall on each other merge at any
// step.
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

struct Body {
  double mass;
  Vec3 position, velocity;
};

json::object system_for(const std::vector<Body>& bodies, double radius, const char* response) {
  json::array masses, positions, velocities;
  for (const Body& b : bodies)
    masses.push_back(b.mass), positions.push_back(vec(b.position)), velocities.push_back(vec(b.velocity));
  return {{"type", "nbody"},
          {"gravitational_constant", 1},
          {"radius", radius},
          {"masses", masses},
          {"positions", positions},
          {"velocities", velocities},
          {"collisions", json::object{{"response", response}, {"restitution", 1}}}};
}

/// Bodies at least two and a half radii and 0.2 m apart within a cube of 2 m.
std::vector<Body> scattered(Dice& d, int n, double radius) {
  std::vector<Body> bodies;
  const double least = std::hypot(2.5 * radius, 0.22);
  while (bodies.size() < static_cast<size_t>(n)) {
    const Body b{d.spread(0.1, 1), d.in_cube(1), d.in_cube(0.3)};
    if (std::ranges::all_of(bodies, [&](const Body& o) { return norm(o.position - b.position) > least; }))
      bodies.push_back(b);
  }
  return bodies;
}

struct Energies {
  double kinetic = 0, potential = 0, heaviest = 0;
  explicit Energies(const std::vector<Body>& bodies) {
    for (size_t i = 0; i < bodies.size(); ++i) {
      const Body& b = bodies[i];
      kinetic += 0.5 * b.mass * norm2(b.velocity), heaviest = std::max(heaviest, b.mass);
      for (size_t j = 0; j < i; ++j)
        potential -= b.mass * bodies[j].mass / norm(b.position - bodies[j].position);
    }
  }
};

/// A method, and a step that it can take: adaptive ones at any, fixed ones at a part of the time of falling.
/// Forces cancel in pairs but for Hermite's, whose bodies take steps of their own and see each other where
/// they are predicted: what is missing is an error of the method (1e-6 to 3e-5 for one scene at six steps),
/// not rounding. Returns by how much momentum (kg m/s, of about 1) may change.
double draw_method(Dice& d, json::object& system, double falling, double& dt) {
  const auto* const name =
      d.of({"", "ias15", "leapfrog", "dopri5", "dop853", "hermite", "yoshida4", "rk4", "rkn86", "tsit5"});
  const std::string_view method = name;
  const bool fixed = method == "leapfrog" || method == "yoshida4" || method == "rk4";
  dt = fixed ? falling * d.spread(0.02, 0.1) : d.spread(0.003, 0.3);
  if (!method.empty()) system["integrator"] = name;
  return method == "hermite" ? 1e-4 : 1e-9;
}

}  // namespace

void bouncing_bodies(Dice& d, Trial& t) {
  constexpr double kSeconds = 3, kMostSteps = 60000;
  const double radius = d.spread(0.01, 0.16);
  const std::vector<Body> bodies = scattered(d, d.of({2, 2, 3, 4, 6}), radius);
  const Energies e(bodies);
  json::object system = system_for(bodies, radius, "bounce");
  double dt;
  t.rules.momentum = draw_method(d, system, std::sqrt(4 * radius * radius * radius / e.heaviest), dt);
  set_scene(t, std::max(dt, kSeconds / kMostSteps), kSeconds, {}, {std::move(system)});
  const double scale = std::max({-e.potential, e.kinetic, e.heaviest * e.heaviest / (2 * radius)});
  expect_near(t, "a.energy.total", e.kinetic + e.potential, 0.01 * scale,
              "bounces without loss keep the energy");
  t.rules.gain = {};
}

void merging_bodies(Dice& d, Trial& t) {
  const double radius = d.spread(0.01, 0.1), apart = d.between(0.5, 2);
  const Vec3 along = d.direction(), drift = d.in_cube(0.2);
  const std::vector<Body> bodies{{d.spread(0.1, 1), along * (-0.5 * apart), drift},
                                 {d.spread(0.1, 1), along * (0.5 * apart), drift}};
  const double masses = bodies[0].mass + bodies[1].mass;
  // They have met after a free fall from `apart`: pi/2 sqrt(d^3 / (2 G m)).
  const double falling = std::acos(0.0) * std::sqrt(apart * apart * apart / (2 * masses));
  json::object system = system_for(bodies, radius, "merge");
  double dt;
  t.rules.momentum = draw_method(d, system, std::sqrt(4 * radius * radius * radius / masses), dt);
  set_scene(t, dt, dt * std::ceil(1.1 * falling / dt), {}, {std::move(system)});
  expect_range(t, "a.collisions", 1, 1, "two bodies that fall from rest meet, and become one");
  t.rules.gain = {};
}

}  // namespace truestep::campaign
