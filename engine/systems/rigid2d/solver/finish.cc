#include "engine/systems/rigid2d/solver/finish.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/flat/distance.h"
#include "engine/rigid/islands.h"
#include "engine/rigid/one_way.h"
#include "engine/rigid/toi_clamp.h"
#include "engine/systems/rigid2d/joint_loads.h"

namespace truestep::rigid2d {
namespace {

using flat::Sweep;

/// The core of a fast shape stops this fraction of its radius before contact.
constexpr double kCoreGap = 0.25;
/// Part of a shape's inner radius by which it may move into a surface that it slides along.
constexpr double kShallow = 0.25;
/// .. by which it may overlap a polygon before that; a higher edge is a step.
constexpr double kLevel = 0.05;
/// rad, by which a body with corners may turn in a step and still slide.
constexpr double kHardlyTurns = 0.02;

Sweep sweep_of(const Pairs& pairs, const Travel& t) {
  return {pairs.pose[t.body], t.angle, t.shift};
}

/// True where the motion of b relative to a hardly crosses the line of a chain's link, or of an edge of a
/// polygon on whose outside it begins: it slides on, from piece to piece. Otherwise the end of the next piece
/// would stop it at every corner, however straight the surface.
bool slides_along(const Outline& piece, const Sweep& a, const Outline& shape, const Sweep& b, double inner) {
  const auto into = [&](Vec2 n) { return -flat::dot(a.from.q * n, b.shift - a.shift); };
  if (piece.is_link()) return std::abs(into(piece.normal[0])) < kShallow * inner;
  // A body that turns far sweeps its corners into surfaces that its middle passes.
  const bool turns = shape.corners > 1 && std::abs(b.angle) > kHardlyTurns;
  if (a.angle != 0 || turns || piece.corners < 3) return false;
  const Outline there = flat::moved(shape, a.from.to(b.from));
  for (uint32_t i = 0; i < piece.corners; ++i) {
    const Vec2 n = piece.normal[i];
    double outside = HUGE_VAL;
    for (uint32_t k = 0; k < there.corners; ++k) {
      outside = std::min(outside, flat::dot(n, there.corner[k] - piece.corner[i]));
    }
    outside -= piece.radius + shape.radius;
    if (outside > -kLevel * inner && into(n) < kShallow * inner) return true;
  }
  return false;
}

/// Fraction of the motion after which the body must stop.
double first_stop(const Model& model, const State& s, const Pairs& pairs, const Travel& me,
                  std::span<const Travel> travels) {
  const Body& body = model.bodies[me.body];
  const Sweep mine = sweep_of(pairs, me);
  const double gap = 0.25 * model.margin;
  const auto status = s.span<uint32_t>(columns::status);
  double stop = 1;
  for (uint32_t i = body.first_shape; i < body.first_shape + body.shapes; ++i) {
    const Outline& shape = model.shapes[i].outline;
    const Outline core = flat::circle(kToiCore * flat::inner_radius(shape), shape.center);
    const auto visit = [&](uint32_t other) {
      const uint32_t at = model.shapes[other].body;
      const Body& obstacle = model.bodies[at];
      if (obstacle.sensor || (status[at] & kRemoved)) return;
      if (!may_touch(model, me.body, at)) return;
      Sweep theirs{pairs.pose[at], 0, {}};
      const auto moved = std::lower_bound(travels.begin(), travels.end(), at,
                                          [](const Travel& t, uint32_t b) { return t.body < b; });
      if (moved != travels.end() && moved->body == at) theirs = sweep_of(pairs, *moved);
      const Outline& wall = model.shapes[other].outline;
      if (wall.side == Outline::Side::left &&
          flat::dot(theirs.from.q * wall.normal[0], mine.from * shape.center - theirs.from * wall.corner[0]) <
              0) {
        return;
      }
      // A body in contact from the start may go on moving, but its core must not pass through.
      const Pose seen = theirs.from.to(mine.from);
      const bool meets =
          !pairs.met.empty() && meeting(pairs, uint64_t{std::min(i, other)} << 32 | std::max(i, other));
      const bool separate = !meets && !slides_along(wall, theirs, shape, mine, flat::inner_radius(shape)) &&
                            flat::distance(wall, shape, seen).distance > 2 * gap;
      // A body inside a one-way body already passes it; one that touches it is left to the solver.
      if (obstacle.one_way && !separate) return;
      const auto hit = flat::time_of_impact(wall, theirs, separate ? shape : core, mine,
                                            separate ? gap : kCoreGap * core.radius);
      if (hit && obstacle.one_way) {
        const Vec2 up = theirs.from.q * obstacle.one_way_direction;
        if (!one_way_holds(flat::dot(hit->normal, up), flat::dot(mine.shift - theirs.shift, up))) return;
      }
      // A body inside a wall may leave it.
      if (hit && hit->fraction == 0 && flat::dot(hit->normal, mine.shift - theirs.shift) > 0) return;
      if (hit) stop = std::min(stop, hit->fraction);
    };
    const Box around = flat::swept_box(shape, mine, body.reach);
    pairs.broad.overlapping(around, Mobility::fixed, visit);
    if (body.bullet) pairs.broad.overlapping(around, Mobility::moving, visit);
  }
  return stop;
}

}  // namespace

void stop_fast_bodies(const Model& model, State& s, const Pairs& pairs, std::span<const Travel> travels,
                      double h, const ThreadArena& arena) {
  const auto status = s.span<uint32_t>(columns::status);
  double *x = s.f64(columns::position).data(), *v = s.f64(columns::velocity).data();
  const auto g = s.f64(columns::parameters);
  const auto angle = s.f64(columns::angle);
  arena.for_blocks(travels.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Travel& t = travels[i];
      const Light& b = model.light[t.body];
      if (!is_moved(b, status[t.body])) continue;
      if (!may_pass_through(flat::norm(t.shift) + std::abs(t.angle) * b.reach, b.inner)) continue;
      const double f = first_stop(model, s, pairs, t, travels);
      if (f >= 1) continue;
      const Vec2 p = pairs.pose[t.body].p + f * t.shift;
      x[3 * t.body] = p.x, x[3 * t.body + 1] = p.y;
      // A body stopped at once still rotates; otherwise a stuck corner would stay stuck.
      if (f > 0) angle[t.body] -= (1 - f) * t.angle;
      // Gravity must not act during the time lost: a body set back would otherwise keep the speed of the
      // fall.
      const double fall = (1 - f) * h * model.dynamics[t.body].gravity_scale;
      v[3 * t.body] -= fall * g[0], v[3 * t.body + 1] -= fall * g[1];
    }
  });
}

namespace {

/// Position and angle of a body relative to those in sleep_place.
struct Way {
  double now[3];
  double *first, *middle;
  double reach;

  double size(auto&& part) const {
    return std::max(flat::norm({part(0), part(1)}), std::abs(part(2)) * reach);
  }
  void begin() const { std::copy(now, now + 3, first); }
  void pass() const { std::copy(now, now + 3, middle); }
  double moved() const {
    return size([&](int k) { return now[k] - first[k]; });
  }
  double bend() const {
    return size([&](int k) { return middle[k] - 0.5 * (first[k] + now[k]); });
  }
};

/// What holds a body: nothing, joints alone, friction with what it touches alone, or both.
enum Hold : uint8_t { kFreeOfHold, kHangsOnJoints, kRollsOnContacts, kHeldByBoth };

void find_holds(const Model& model, const State& s, const Pairs& pairs, std::vector<uint8_t>& holds) {
  const size_t n = model.count();
  holds.assign(n, kFreeOfHold);
  for (const Hit& hit : pairs.hits) {
    if (hit.what != Hit::What::touching) continue;
    const bool grips = model.surfaces[hit.body_a].friction * model.surfaces[hit.body_b].friction > 0;
    for (const uint32_t i : {hit.body_a, hit.body_b}) {
      if (i < n) holds[i] = std::max<uint8_t>(holds[i], grips ? kRollsOnContacts : kHeldByBoth);
    }
  }
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  for (size_t j = 0; j < model.joints.size(); ++j) {
    if (broken[j]) continue;
    for (const uint32_t i : {model.joints[j].a, model.joints[j].b}) {
      if (i < n) holds[i] = holds[i] <= kHangsOnJoints ? kHangsOnJoints : kHeldByBoth;
    }
  }
}

/// Counts how long bodies have rested and returns the longest time. `holds` is computed when a body first
/// needs it.
double longest_rest(const Model& model, State& s, const Pairs& pairs, const SleepRule& rule, double h,
                    std::vector<uint8_t>& holds) {
  const SleepRule of_rolling = rule.of_rolling(), of_hanging = rule.of_hanging();
  holds.clear();
  const auto rule_of = [&](size_t i) -> const SleepRule& {
    if (holds.empty()) find_holds(model, s, pairs, holds);
    return holds[i] == kRollsOnContacts ? of_rolling : holds[i] == kHangsOnJoints ? of_hanging : rule;
  };
  // Up to this distance both rules agree until the time is over.
  const double near = model.joints.empty() ? rule.drift() : of_hanging.drift();
  const auto status = s.span<uint32_t>(columns::status);
  const auto rest = s.f64(columns::sleep_timer), w = s.f64(columns::angular_velocity),
             angle = s.f64(columns::angle);
  const double* v = s.f64(columns::velocity).data();
  const double* x = s.f64(columns::position).data();
  double* place = s.f64(columns::sleep_place).data();
  double longest = 0;
  for (size_t i = 0; i < model.count(); ++i) {
    const Light& b = model.light[i];
    if (!is_moved(b, status[i])) continue;
    const double speed = std::max(flat::norm({v[3 * i], v[3 * i + 1]}), std::abs(w[i]) * b.reach);
    const Way way{{x[3 * i], x[3 * i + 1], angle[i]}, place + 6 * i, place + 6 * i + 3, b.reach};
    const bool over = rest[i] < rule.time && rest[i] + h >= rule.time;
    const bool differ = rest[i] > 0 && speed <= rule.speed && (over || way.moved() > near);
    count_rest(rest[i], h, b.can_sleep ? speed : kNoRest, differ ? rule_of(i) : rule, way);
    longest = std::max(longest, rest[i]);
  }
  return longest;
}

}  // namespace

namespace {

/// True where a motor drives its bodies. One that is at its target lets them sleep.
bool motor_runs(const Joint& j, const Model& model, const State& s, double sleep_speed) {
  const Motor motor = motor_of(s, j);
  if (j.kind == JointKind::motor) {
    return (j.at_velocity && flat::dot(motor.wanted, motor.wanted) > 0) || (j.at_spin && motor.turn != 0);
  }
  if (motor.most == 0 || j.kind == JointKind::mouse) return false;
  if (!j.has_target) return motor.wanted.x != 0;
  constexpr double kAtRest = 0.01;  // of sleep_speed, as in space
  const double at = j.kind == JointKind::prismatic ? joint_coordinate(j, model, s) : joint_angle(j, s);
  return std::abs(j.motor_rate * (motor.wanted.x - at)) > kAtRest * sleep_speed;
}

}  // namespace

void fall_asleep(const Model& model, State& s, const Pairs& pairs, const SleepRule& rule, double h,
                 Sleepers& scratch) {
  const size_t n = model.count();
  if (longest_rest(model, s, pairs, rule, h, scratch.holds) < rule.time) return;
  const auto status = s.span<uint32_t>(columns::status);
  const auto rest = s.f64(columns::sleep_timer), w = s.f64(columns::angular_velocity);
  const auto impulse = s.span<float>(columns::contact_impulse);
  double* v = s.f64(columns::velocity).data();
  auto& [parent, rested, unborne, still, holds] = scratch;
  parent.resize(n), still.resize(n);
  unborne.assign(n, 1);
  start_islands(parent);
  rested.assign(rest.begin(), rest.end());
  for (size_t i = 0; i < n; ++i) {
    if (!is_moved(model.light[i], status[i])) rested[i] = HUGE_VAL;
    still[i] = v[3 * i] == 0 && v[3 * i + 1] == 0 && w[i] == 0;
  }
  const auto join = [&](uint32_t a, uint32_t b, bool bears) {
    const bool moved_a = a < n && is_moved(model.light[a], status[a]);
    const bool moved_b = b < n && is_moved(model.light[b], status[b]);
    if (moved_a && moved_b) return link_islands(parent, a, b);
    // Belts and lifts keep their load awake.
    const auto carries = [&](uint32_t i) {
      return pairs.active[i] || (i < n && model.surfaces[i].speed != 0);
    };
    if (moved_a && carries(b)) rested[a] = 0;
    if (moved_b && carries(a)) rested[b] = 0;
    if (moved_a && bears) unborne[a] = 0;
    if (moved_b && bears) unborne[b] = 0;
  };
  size_t row = 0;
  for (const Hit& hit : pairs.hits) {
    if (hit.what < Hit::What::touching) continue;
    const bool bears = impulse[5 * row] > 0 || impulse[5 * row + 1] > 0;
    ++row;
    if (hit.what == Hit::What::touching) join(hit.body_a, hit.body_b, bears);
  }
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  for (size_t j = 0; j < model.joints.size(); ++j) {
    const Joint& d = model.joints[j];
    if (broken[j]) continue;
    join(d.a, d.b, true);
    // A running motor keeps its bodies awake.
    if (d.motor_row != kNoMotor && motor_runs(d, model, s, rule.speed)) {
      for (const uint32_t i : {d.a, d.b}) {
        if (i < n) rested[i] = 0;
      }
    }
  }
  spread_minimum<double>(parent, rested);
  spread_minimum<uint8_t>(parent, unborne);
  spread_minimum<uint8_t>(parent, still);
  for (size_t i = 0; i < n; ++i) {
    if (!is_moved(model.light[i], status[i]) || rested[i] < rule.time) continue;
    if (unborne[i] && !still[i]) continue;
    status[i] = 0;
    v[3 * i] = v[3 * i + 1] = 0, w[i] = 0;
  }
}

}  // namespace truestep::rigid2d
