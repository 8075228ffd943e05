// Collisions, and overlaps at the start: two bodies head-on with round numbers, and bodies at one place.
#include <cmath>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

/// v and M of two bodies on the x axis that meet elastically.
struct Hit {
  double left, right, size_left, size_right, gap, mass_left, mass_right, dt;
};

Hit draw(Dice& d) {
  Hit h;
  h.left = d.of({2.0, 3.0, 4.0, 5.0, 6.0, 10.0}), h.right = d.of({0.0, 0.0, -1.0, -2.0, -5.0});
  h.size_left = d.of({0.25, 0.5, 1.0}), h.size_right = d.of({0.25, 0.5, 1.0});
  h.gap = d.of({0.5, 1.0, 1.5, 2.0, 3.0, 0.1});
  h.mass_left = d.of({1.0, 1.0, 10.0, 1e3, 1e6}), h.mass_right = d.of({1.0, 1.0, 10.0, 1e3, 1e6});
  h.dt = d.of({1.0 / 60, 1.0 / 60, 1.0 / 64, 0.01, 1.0 / 120});
  return h;
}

void judge_hit(Dice& d, Trial& t, const Hit& h, json::object system, double e) {
  const double closing = h.left - h.right, seconds = h.gap / closing + 0.5;
  set_scene(t, h.dt, seconds, {}, {std::move(system)});
  const double sum = h.mass_left + h.mass_right,
               centre = (h.mass_left * h.left + h.mass_right * h.right) / sum;
  const double tolerance = 0.01 * closing;
  probe(t, "left", 0, {"velocity"}), probe(t, "right", 1, {"velocity"});
  expect_near(t, "left.velocity.x", centre - e * h.mass_right / sum * closing, tolerance,
              "Newton's law of impact");
  expect_near(t, "right.velocity.x", centre + e * h.mass_left / sum * closing, tolerance,
              "Newton's law of impact");
  // The recoil of a million kilograms is slower than the sleep threshold.
  system_of(t)["sleeping"] = false;
  t.rules.gain = 1e-4;
  t.rules.momentum = 1e-4 * (h.mass_left * std::abs(h.left) + h.mass_right * std::abs(h.right));
  if (d.chance(0.3)) system_of(t)["precision"] = "f64";
}

double bounce(Dice& d) {
  return d.chance(0.7) ? 1 : d.of({0.0, 0.3, 0.5, 0.9});
}

}  // namespace

void hit_2d(Dice& d, Trial& t) {
  const Hit h = draw(d);
  const double e = bounce(d);
  const auto body = [&](double x, double v, double size, double mass) {
    const json::object shape = d.chance(0.6)
                                   ? json::object{{"type", "circle"}, {"radius", size}}
                                   : json::object{{"type", "box"}, {"half_extents", vec(size, size)}};
    return json::object{{"position", vec(x, 0)},
                        {"velocity", vec(v, 0)},
                        {"mass", mass},
                        {"restitution", e},
                        {"shapes", json::array{shape}}};
  };
  judge_hit(d, t, h,
            {{"type", "rigid2d"},
             {"bodies",
              json::array{body(0, h.left, h.size_left, h.mass_left),
                          body(h.size_left + h.gap + h.size_right, h.right, h.size_right, h.mass_right)}}},
            e);
}

void hit_3d(Dice& d, Trial& t) {
  const Hit h = draw(d);
  const double e = bounce(d);
  const auto body = [&](double x, double v, double size, double mass) {
    json::object b{{"position", vec(x, 0)}, {"velocity", vec(v, 0)}, {"mass", mass}, {"restitution", e}};
    if (d.chance(0.6)) {
      b["type"] = "sphere", b["radius"] = size;
    } else {
      b["type"] = "box", b["half_extents"] = vec(size, size, size);
    }
    return b;
  };
  judge_hit(d, t, h,
            {{"type", "rigid3d"},
             {"bodies",
              json::array{body(0, h.left, h.size_left, h.mass_left),
                          body(h.size_left + h.gap + h.size_right, h.right, h.size_right, h.mass_right)}}},
            e);
}

namespace {

/// Nothing may separate faster than push_out_speed, or half as much again for what many neighbours give at
/// once.
constexpr double kPushOut = 3, kFastest = 1.5 * kPushOut;

/// Energy that this separation may add.
void judge_parting(Trial& t, int n, double mass) {
  const double most = 0.5 * n * mass * kFastest * kFastest;
  t.rules.stored = most;
  expect_range(t, "max(energy.kinetic)", 0, most, "bodies part at push_out_speed");
}

Vec3 place(Dice& d, bool same, double radius) {
  return same ? Vec3{} : d.in_cube(0.5 * radius);
}

}  // namespace

void overlap_2d(Dice& d, Trial& t) {
  const int n = d.whole(2, 40);
  const double r = d.between(0.2, 0.5), dt = usual_dt(d);
  const bool same = d.chance(0.3);
  json::array bodies;
  for (int i = 0; i < n; ++i) {
    const Vec3 at = place(d, same, r);
    bodies.push_back(json::object{{"position", vec(at.x, at.y)},
                                  {"mass", 1},
                                  {"shapes", json::array{{{"type", "circle"}, {"radius", r}}}}});
  }
  set_scene(t, dt, 0.5, {}, {{{"type", "rigid2d"}, {"push_out_speed", kPushOut}, {"bodies", bodies}}});
  judge_parting(t, n, 1);
}

void overlap_3d(Dice& d, Trial& t) {
  const int n = d.whole(2, 60);
  const double r = d.between(0.2, 0.5), dt = usual_dt(d);
  const bool same = d.chance(0.3);
  json::array bodies;
  for (int i = 0; i < n; ++i)
    bodies.push_back(
        json::object{{"type", "sphere"}, {"position", vec(place(d, same, r))}, {"mass", 1}, {"radius", r}});
  set_scene(t, dt, 0.5, {}, {{{"type", "rigid3d"}, {"bodies", bodies}}});
  judge_parting(t, n, 1);
  expect_range(t, "max(a.speed.largest)", 0, 2 * kPushOut, "bodies part at push_out_speed");
}

}  // namespace truestep::campaign
