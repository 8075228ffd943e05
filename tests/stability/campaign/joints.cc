// Bodies joined in chains without gravity: every kind of joint with and without limits, and undamped springs,
// in closed systems whose energy must not grow and whose momentum is conserved; and a pendulum on a hinge.
#include <algorithm>
#include <cmath>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

constexpr double kSpacing = 1;

/// Bounds for the change of the total momenta of n such bodies.
void close(Trial& t, int n, double mass, double speed, double share) {
  t.rules.momentum = share * n * mass * speed;
  // Joint impulses act at the positions that the bodies have within the step.
  t.rules.angular_momentum = 5 * share * n * mass * speed * (1 + 0.5 * n * kSpacing);
}

json::object limited(Dice& d, json::object joint, double reach) {
  if (d.chance(0.5))
    joint["lower"] = -d.between(0.05, 1) * reach, joint["upper"] = d.between(0.05, 1) * reach;
  return joint;
}

/// An undamped spring: by stiffness or by frequency where the joint knows both.
json::object sprung(Dice& d, std::string_view by) {
  if (by == "stiffness") return {{"stiffness", d.spread(1, 1e5)}, {"damping", 0}};
  return {{"hertz", d.spread(0.5, 30)}, {"damping_ratio", 0}};
}

/// Fraction by which the energy of springs may oscillate if the fastest one alone has w (1/s), in substeps of
/// h: next to rigid rows, velocities are half a substep off the positions, which gives h w / 2, and
/// neighbours make w up to sqrt 2 times as large. Between two points alone it is (h w)^2 / 8.
double swing(double h, double w) {
  return std::max(0.08, h * w / std::numbers::sqrt2);
}

json::array chain_2d(Dice& d, int n, double speed) {
  json::array bodies;
  for (int i = 0; i < n; ++i) {
    bodies.push_back(json::object{
        {"position", vec(kSpacing * i, 0)},
        {"velocity", vec(d.between(-speed, speed), d.between(-speed, speed))},
        {"angular_velocity", d.between(-2, 2) * speed},
        {"mass", d.spread(0.3, 3)},
        {"mask", 0},
        {"shapes",
         json::array{d.chance(0.5) ? json::object{{"type", "circle"}, {"radius", 0.3}}
                                   : json::object{{"type", "box"}, {"half_extents", vec(0.4, 0.2)}}}}});
  }
  return bodies;
}

json::array chain_3d(Dice& d, int n, double speed) {
  json::array bodies;
  for (int i = 0; i < n; ++i) {
    json::object b{{"position", vec(kSpacing * i, 0)},
                   {"velocity", vec(d.in_cube(speed))},
                   {"angular_velocity", vec(d.in_cube(2 * speed))},
                   {"mass", d.spread(0.3, 3)},
                   {"mask", 0}};
    if (d.chance(0.5)) {
      b["type"] = "sphere", b["radius"] = 0.3;
    } else {
      b["type"] = "box", b["half_extents"] = vec(0.4, 0.2, 0.3);
    }
    bodies.push_back(b);
  }
  return bodies;
}

json::array anchor(int i) {
  return vec(kSpacing * (i + 0.5), 0);
}

/// Axes at right angles to one another.
std::pair<Vec3, Vec3> axes(Dice& d) {
  const Vec3 a = d.direction();
  const Vec3 b = cross(a, std::abs(a.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
  return {a, b / norm(b)};
}

}  // namespace

void joints_2d(Dice& d, Trial& t) {
  const int n = d.whole(2, 5);
  const double speed = d.spread(0.1, 3), dt = usual_dt(d);
  json::array joints;
  for (int i = 0; i + 1 < n; ++i) {
    const std::string kind = d.of({"revolute", "prismatic", "distance", "weld", "wheel"});
    json::object j{{"type", kind}, {"a", i}, {"b", i + 1}};
    if (kind == "distance") {
      j["anchor"] = vec(kSpacing * (i + 0.2), 0), j["anchor_b"] = vec(kSpacing * (i + 0.8), 0);
      if (d.chance(0.5)) j["minimum"] = 0.4, j["maximum"] = 0.8;
    } else {
      j["anchor"] = anchor(i);
    }
    if (kind == "prismatic" || kind == "wheel") {
      const double a = d.between(0, 2 * std::numbers::pi);
      j["axis"] = vec(std::cos(a), std::sin(a));
    }
    if (kind == "revolute" || kind == "prismatic" || kind == "wheel") j = limited(d, j, 1);
    joints.push_back(j);
  }
  json::array bodies = chain_2d(d, n, speed);
  set_scene(t, dt, 3, {}, {{{"type", "rigid2d"}, {"bodies", bodies}, {"joints", joints}}});
  if (d.chance(0.2)) system_of(t)["precision"] = "f64";
  close(t, n, 3, speed, 1e-3);
  t.rules.still = 2e-3;
}

void joints_3d(Dice& d, Trial& t) {
  const int n = d.whole(2, 5);
  const double speed = d.spread(0.1, 3), dt = usual_dt(d);
  json::array joints;
  for (int i = 0; i + 1 < n; ++i) {
    const std::string kind = d.of({"ball", "fixed", "hinge", "slider", "cylindrical", "plane", "distance",
                                   "universal", "cone_twist", "six_dof"});
    const auto [axis, across] = axes(d);
    json::object j{{"type", kind}, {"a", i}, {"b", i + 1}, {"anchor", anchor(i)}};
    if (kind != "ball" && kind != "fixed" && kind != "distance") j["axis"] = vec(axis);
    if (kind == "hinge" || kind == "slider") j = limited(d, j, 1);
    if (kind == "universal") j["axis_b"] = vec(across);
    if (kind == "distance") {
      j["anchor"] = vec(kSpacing * (i + 0.2), 0), j["anchor_b"] = vec(kSpacing * (i + 0.8), 0);
      if (d.chance(0.5)) j["minimum"] = 0.4, j["maximum"] = 0.8;
    }
    if (kind == "cylindrical") {
      j["slide"] = limited(d, {}, 0.5), j["turn"] = limited(d, {}, 1);
    }
    if (kind == "cone_twist" && d.chance(0.7)) {
      j["swing"] = d.between(0.1, 1.5), j["twist_lower"] = -d.between(0.1, 1),
      j["twist_upper"] = d.between(0.1, 1);
    }
    if (kind == "six_dof") {
      for (const char* way : {"x", "turn_x", "turn_z"}) {
        if (d.chance(0.5)) j[way] = limited(d, {}, 0.5);
      }
    }
    joints.push_back(j);
  }
  json::array bodies = chain_3d(d, n, speed);
  set_scene(t, dt, 3, {}, {{{"type", "rigid3d"}, {"bodies", bodies}, {"joints", joints}}});
  if (d.chance(0.2)) system_of(t)["precision"] = "f64";
  close(t, n, 3, speed, 1e-3);
  t.rules.still = 2e-3;
}

void springs_2d(Dice& d, Trial& t) {
  const int n = d.whole(2, 4);
  const double speed = d.spread(0.3, 3), dt = usual_dt(d);
  json::array joints, bodies = chain_2d(d, n, speed);
  const auto mass = [&](int i) {
    return bodies[static_cast<size_t>(i)].as_object()["mass"].to_number<double>();
  };
  double stored = 0, fastest = 0;
  for (int i = 0; i + 1 < n; ++i) {
    const std::string kind = d.of({"distance", "distance", "prismatic", "revolute", "weld", "wheel"});
    json::object j{{"type", kind}, {"a", i}, {"b", i + 1}};
    if (kind == "distance") {
      j["anchor"] = vec(kSpacing * i, 0), j["anchor_b"] = vec(kSpacing * (i + 1), 0);
    } else {
      j["anchor"] = anchor(i);
    }
    if (kind == "prismatic" || kind == "wheel") j["axis"] = vec(1, 0);
    const double hertz = d.spread(0.5, 30) * std::min(1.0, 1.0 / (60 * dt));
    fastest = std::max(fastest, 2 * std::numbers::pi * hertz);
    j["hertz"] = hertz, j["damping_ratio"] = 0;
    if (kind == "distance" && d.chance(0.6)) {
      // Between centres, the frequency is that of the reduced mass.
      const double rest = kSpacing * d.between(0.6, 1.4), w = 2 * std::numbers::pi * hertz;
      const double reduced = mass(i) * mass(i + 1) / (mass(i) + mass(i + 1)), off = kSpacing - rest;
      j["length"] = rest, stored += 0.5 * reduced * w * w * off * off;
    }
    joints.push_back(j);
  }
  set_scene(t, dt, 4, {}, {{{"type", "rigid2d"}, {"bodies", bodies}, {"joints", joints}}});
  close(t, n, 3, speed + std::sqrt(stored), 1e-3);
  t.rules.gain = swing(dt / 4, fastest), t.rules.stored = stored;
}

void springs_3d(Dice& d, Trial& t) {
  const int n = d.whole(2, 4);
  const double speed = d.spread(0.3, 3), dt = usual_dt(d);
  json::array joints;
  // A spring given by stiffness may start stretched, which stores k s^2 / 2.
  double stored = 0, fastest = 0;
  // Two bodies of at least 0.3 kg, and with the inertia of a ball of that mass, have a reduced mass and
  // inertia of half of these.
  const auto rate = [](const json::object& s, double inertia) {
    if (s.contains("hertz")) return 2 * std::numbers::pi * s.at("hertz").to_number<double>();
    return std::sqrt(s.at("stiffness").to_number<double>() / (0.5 * inertia));
  };
  constexpr double kLeastMass = 0.3, kLeastInertia = 0.4 * kLeastMass * 0.3 * 0.3;
  // What a force feels that acts on such a body at `lever` from its centre, across the lever.
  const auto mass_at = [](double lever) { return 1 / (1 / kLeastMass + lever * lever / kLeastInertia); };
  const auto drive = [&](const char* by, double reach, double inertia) {
    json::object s = sprung(d, by);
    fastest = std::max(fastest, rate(s, inertia));
    if (s.contains("stiffness") && d.chance(0.6)) {
      const double off = d.sign() * d.between(0.1, 1) * reach;
      s["rest"] = off, stored += 0.5 * s["stiffness"].to_number<double>() * off * off;
    }
    return s;
  };
  for (int i = 0; i + 1 < n; ++i) {
    const std::string kind = d.of({"spring", "spring", "hinge", "slider", "six_dof"});
    const char* by = d.of({"stiffness", "hertz"});
    json::object j;
    if (kind == "spring") {
      j = sprung(d, by);
      const Vec3 off = d.chance(0.6) ? d.in_cube(0.2) : Vec3{};
      fastest = std::max(fastest, rate(j, mass_at(norm(off))));
      const Vec3 from = Vec3{kSpacing * i, 0, 0} + off, to = Vec3{kSpacing * (i + 1), 0, 0} - off;
      j["anchor"] = vec(from), j["anchor_b"] = vec(to);
      if (j.contains("stiffness") && d.chance(0.6)) {
        const double length = norm(to - from), rest = length * d.between(0.5, 1.5);
        j["length"] = rest;
        stored += 0.5 * j["stiffness"].to_number<double>() * (length - rest) * (length - rest);
      }
    } else if (kind == "six_dof") {
      for (const char* way : {"x", "y"}) {
        if (d.chance(0.6)) j[way] = drive(by, 0.3, mass_at(0.5 * kSpacing));
      }
      if (d.chance(0.6)) j["turn_x"] = drive(by, 1, kLeastInertia);
    } else {
      const bool turns = kind == "hinge";
      j = drive(by, turns ? 1 : 0.3, turns ? kLeastInertia : mass_at(0.5 * kSpacing));
    }
    if (kind != "spring") j["anchor"] = anchor(i), j["axis"] = vec(axes(d).first);
    j["type"] = kind, j["a"] = i, j["b"] = i + 1;
    joints.push_back(j);
  }
  json::array bodies = chain_3d(d, n, speed);
  set_scene(t, dt, 4, {}, {{{"type", "rigid3d"}, {"bodies", bodies}, {"joints", joints}}});
  close(t, n, 3, speed + std::sqrt(stored), 1e-3);
  // Beyond h w = 1/2 the solver removes energy from a spring.
  const double small = dt / 5, w = std::min(fastest, 0.5 / small);
  t.rules.gain = swing(small, w), t.rules.stored = stored;
}

void hinge_pendulum(Dice& d, Trial& t) {
  const double l = d.between(0.4, 2), angle = d.between(1, 2.7), dt = usual_dt(d);
  const double x = l * std::sin(angle), y = -l * std::cos(angle);
  const bool plane = d.chance(0.5);
  if (plane) {
    const json::object bob{{"position", vec(x, y)},
                           {"mass", d.spread(0.1, 100)},
                           {"shapes", json::array{{{"type", "box"}, {"half_extents", vec(0.2, 0.1)}}}}};
    set_scene(
        t, dt, 6, {0, -9.81, 0},
        {{{"type", "rigid2d"},
          {"bodies", json::array{bob}},
          {"joints", json::array{{{"type", "revolute"}, {"a", -1}, {"b", 0}, {"anchor", vec(0, 0)}}}}}});
  } else {
    const json::object bob{{"type", "box"},
                           {"half_extents", vec(0.2, 0.1, 0.15)},
                           {"position", vec(x, y)},
                           {"mass", d.spread(0.1, 100)}};
    set_scene(
        t, dt, 6, {0, -9.81, 0},
        {{{"type", "rigid3d"},
          {"bodies", json::array{bob}},
          {"joints",
           json::array{
               {{"type", "hinge"}, {"a", -1}, {"b", 0}, {"anchor", vec(0, 0)}, {"axis", vec(0, 0, 1)}}}}}});
  }
  // Velocities are half a substep of at most dt / 4 off the positions: the total oscillates by m g v h / 2.
  t.rules.gain = std::max(0.01, 0.25 * dt * std::sqrt(9.81 / l));
  // Five per cent in six seconds: several times what the solver in the plane loses.
  t.rules.loss = 0.05;
  expect_range(t, "max(a.joints.gap)", 0, 0.05 * l, "the joint holds");
}

}  // namespace truestep::campaign
