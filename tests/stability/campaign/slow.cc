// Slow motions that are not rest: falls in weak gravity, pendulums of one degree, pairs that drift. None may
// sleep.
#include <cmath>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

struct Slow {
  enum class Kind { falls, swings, drifts } kind;
  double value;  // m/s^2, rad, m/s
};

Slow draw(Dice& d) {
  const auto kind = d.of({Slow::Kind::falls, Slow::Kind::swings, Slow::Kind::drifts});
  return {kind, kind == Slow::Kind::falls    ? d.between(0.02, 0.15)
                : kind == Slow::Kind::swings ? d.between(0.3, 1.5) * kDegree
                                             : d.spread(5e-3, 0.1)};
}

/// One body falls from `height` above the ground; judged before it lands.
void judge_fall(Trial& t, double g, double height, double seconds) {
  probe(t, "body", 1, {"position"});
  expect_near(t, "body.position.y", height - 0.5 * g * seconds * seconds,
              0.02 * 0.5 * g * seconds * seconds + 1e-4, "h - g t^2 / 2");
}

void judge_swing(Trial& t, double length, double angle) {
  // A point pendulum except for the body's own inertia, 2.5 % of m l^2; amplitudes are small: the energy
  // tells how far it still swings.
  const double potential = 9.81 * length * (1 - std::cos(angle));
  // A joint sags as far as its body falls in a substep, of which a step has at most four.
  const double small = t.scene["time"].as_object()["dt"].to_number<double>() / 4;
  t.rules.loss = 0.5 + 0.5 * 9.81 * 9.81 * small * small / potential;
  expect_range(t, "max(energy.kinetic)", 0.5 * potential, 1.1 * potential,
               "what falling by a degree's height gives");
}

}  // namespace

void slow_2d(Dice& d, Trial& t) {
  const Slow s = draw(d);
  const auto disk = [](double x, double y, double v) {
    return json::object{{"position", vec(x, y)},
                        {"velocity", vec(v, 0)},
                        {"mass", 1},
                        {"shapes", json::array{{{"type", "circle"}, {"radius", 0.2}}}}};
  };
  const json::object floor{{"motion", "fixed"},
                           {"position", vec(0, -1)},
                           {"shapes", json::array{{{"type", "box"}, {"half_extents", vec(10, 1)}}}}};
  t.rules.still = 2e-3;
  if (s.kind == Slow::Kind::falls) {
    const double height = 3;
    set_scene(t, usual_dt(d), 3, {0, -s.value, 0},
              {{{"type", "rigid2d"}, {"bodies", json::array{floor, disk(0, height, 0)}}}});
    judge_fall(t, s.value, height, 3);
  } else if (s.kind == Slow::Kind::swings) {
    const double l = d.between(0.5, 2);
    set_scene(
        t, usual_dt(d), 6, {0, -9.81, 0},
        {{{"type", "rigid2d"},
          {"bodies", json::array{floor, disk(l * std::sin(s.value), 5 - l * std::cos(s.value), 0)}},
          {"joints", json::array{{{"type", "revolute"}, {"a", -1}, {"b", 1}, {"anchor", vec(0, 5)}}}}}});
    judge_swing(t, l, s.value);
  } else {
    const bool touching = d.chance(0.6);
    set_scene(t, usual_dt(d), 3, {},
              {{{"type", "rigid2d"},
                {"bodies", json::array{disk(0, 0, s.value), disk(touching ? 0.4 : 1, 0, s.value)}}}});
    t.rules.momentum = 2e-3 * 2;
  }
}

void slow_3d(Dice& d, Trial& t) {
  const Slow s = draw(d);
  const auto ball = [](double x, double y, double v) {
    return json::object{
        {"type", "sphere"}, {"position", vec(x, y)}, {"velocity", vec(v, 0)}, {"mass", 1}, {"radius", 0.2}};
  };
  const json::object floor{{"type", "plane"}, {"motion", "fixed"}};
  t.rules.still = 2e-3;
  if (s.kind == Slow::Kind::falls) {
    const double height = 3;
    set_scene(t, usual_dt(d), 3, {0, -s.value, 0},
              {{{"type", "rigid3d"}, {"bodies", json::array{floor, ball(0, height, 0)}}}});
    judge_fall(t, s.value, height, 3);
  } else if (s.kind == Slow::Kind::swings) {
    const double l = d.between(0.5, 2);
    set_scene(
        t, usual_dt(d), 6, {0, -9.81, 0},
        {{{"type", "rigid3d"},
          {"bodies", json::array{floor, ball(l * std::sin(s.value), 5 - l * std::cos(s.value), 0)}},
          {"joints",
           json::array{
               {{"type", "hinge"}, {"a", -1}, {"b", 1}, {"anchor", vec(0, 5)}, {"axis", vec(0, 0, 1)}}}}}});
    judge_swing(t, l, s.value);
  } else {
    const bool touching = d.chance(0.6);
    set_scene(t, usual_dt(d), 3, {},
              {{{"type", "rigid3d"},
                {"bodies", json::array{ball(0, 0, s.value), ball(touching ? 0.4 : 1, 0, s.value)}}}});
    t.rules.momentum = 2e-3 * 2;
  }
}

}  // namespace truestep::campaign
