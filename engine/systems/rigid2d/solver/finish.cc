#include "engine/systems/rigid2d/solver/finish.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/flat/distance.h"
#include "engine/rigid/islands.h"
#include "engine/rigid/toi_clamp.h"

namespace truestep::rigid2d {
namespace {

using flat::Sweep;

/// The core of a fast shape stops this fraction of its radius before contact.
constexpr double kCoreGap = 0.25;

Sweep sweep_of(const Pairs& pairs, const Travel& t) {
  return {pairs.pose[t.body], t.angle, t.shift};
}

Box swept_box(const Outline& s, const Sweep& sweep, double reach) {
  Box b = flat::bounds(s, sweep.from);
  b.cover(flat::bounds(s, sweep.at(1)));
  // In between, a rotating outline stays within its reach of the path of its centre.
  if (sweep.angle != 0) {
    const double slack = reach * std::min(1.0, std::abs(sweep.angle));
    b = b.grown(slack);
  }
  b.low.z = b.high.z = 0;
  return b;
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
      if (obstacle.one_way || obstacle.sensor || (status[at] & kRemoved)) return;
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
      const bool separate = flat::distance(wall, shape, seen).distance > 2 * gap;
      const auto hit = flat::time_of_impact(wall, theirs, separate ? shape : core, mine,
                                            separate ? gap : kCoreGap * core.radius);
      // A body inside a wall may leave it.
      if (hit && hit->fraction == 0 && flat::dot(hit->normal, mine.shift - theirs.shift) > 0) return;
      if (hit) stop = std::min(stop, hit->fraction);
    };
    const Box around = swept_box(shape, mine, body.reach);
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

/// Marks bodies that touch others only with friction and that no joint holds.
void find_rolling(const Model& model, const State& s, const Pairs& pairs, std::vector<uint8_t>& rolls) {
  constexpr uint8_t kFree = 0, kRolls = 1, kHeld = 2;
  const size_t n = model.count();
  rolls.assign(n, kFree);
  const auto hold = [&](uint32_t i, uint8_t by) {
    if (i < n) rolls[i] = std::max(rolls[i], by);
  };
  for (const Hit& hit : pairs.hits) {
    if (hit.what != Hit::What::touching) continue;
    const bool grips = model.surfaces[hit.body_a].friction * model.surfaces[hit.body_b].friction > 0;
    for (const uint32_t i : {hit.body_a, hit.body_b}) hold(i, grips ? kRolls : kHeld);
  }
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  for (size_t j = 0; j < model.joints.size(); ++j) {
    if (broken[j]) continue;
    hold(model.joints[j].a, kHeld), hold(model.joints[j].b, kHeld);
  }
  for (uint8_t& r : rolls) r = r == kRolls;
}

/// Counts how long bodies have rested and returns the longest time. `rolls` is computed when a body first
/// needs it.
double longest_rest(const Model& model, State& s, const Pairs& pairs, const SleepRule& rule, double h,
                    std::vector<uint8_t>& rolls) {
  const SleepRule of_rolling = rule.of_rolling();
  rolls.clear();
  const auto rolling = [&](size_t i) {
    if (rolls.empty()) find_rolling(model, s, pairs, rolls);
    return rolls[i] != 0;
  };
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
    // Below this distance both rules agree.
    const bool far = rest[i] > 0 && speed <= rule.speed && way.moved() > rule.drift();
    count_rest(rest[i], h, b.can_sleep ? speed : kNoRest, far && rolling(i) ? of_rolling : rule, way);
    longest = std::max(longest, rest[i]);
  }
  return longest;
}

}  // namespace

void fall_asleep(const Model& model, State& s, const Pairs& pairs, const SleepRule& rule, double h,
                 Sleepers& scratch) {
  const size_t n = model.count();
  if (longest_rest(model, s, pairs, rule, h, scratch.rolls) < rule.time) return;
  const auto status = s.span<uint32_t>(columns::status);
  const auto rest = s.f64(columns::sleep_timer), w = s.f64(columns::angular_velocity);
  const auto impulse = s.span<float>(columns::contact_impulse);
  double* v = s.f64(columns::velocity).data();
  auto& [parent, rested, unborne, still, rolls] = scratch;
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
    if (d.has_motor && d.motor_speed != 0) {
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
