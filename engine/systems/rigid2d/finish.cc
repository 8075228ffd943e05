#include "engine/systems/rigid2d/finish.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/flat/distance.h"
#include "engine/kernels/islands.h"

namespace truestep::rigid2d {
namespace {

using flat::Sweep;

/// Radius of the circle within a fast shape that passes nothing, as a share of the shape's inner radius.
constexpr double kCore = 0.25;
/// It stops that share of its radius before it touches.
constexpr double kCoreGap = 0.25;

Sweep sweep_of(const Pairs& pairs, const Travel& t) {
  return {pairs.pose[t.body], t.angle, t.shift};
}

Box swept_box(const Outline& s, const Sweep& sweep, double reach) {
  Box b = flat::bounds(s, sweep.from);
  b.cover(flat::bounds(s, sweep.at(1)));
  // In between, a turning outline stays within its reach of the centre's path.
  if (sweep.angle != 0) {
    const double slack = reach * std::min(1.0, std::abs(sweep.angle));
    b = b.grown(slack);
  }
  b.low.z = b.high.z = 0;
  return b;
}

/// Fraction of its motion after which the body must stop.
double first_stop(const Model& model, const State& s, const Pairs& pairs, const Travel& me,
                  std::span<const Travel> travels) {
  const Body& body = model.bodies[me.body];
  const Sweep mine = sweep_of(pairs, me);
  const double gap = 0.25 * model.margin;
  const auto status = s.span<uint32_t>(columns::status);
  double stop = 1;
  for (uint32_t i = body.first_shape; i < body.first_shape + body.shapes; ++i) {
    const Outline& shape = model.shapes[i].outline;
    const Outline core = flat::circle(kCore * flat::inner_radius(shape), shape.center);
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
      if (wall.is_link() && flat::dot(theirs.from.q * wall.normal[0],
                                      mine.from * shape.center - theirs.from * wall.corner[0]) < 0) {
        return;
      }
      // What touches from the start may move on, but never so far that its core goes through.
      const Pose seen = theirs.from.to(mine.from);
      const bool apart = flat::distance(wall, shape, seen).distance > 2 * gap;
      const auto hit = flat::time_of_impact(wall, theirs, apart ? shape : core, mine,
                                            apart ? gap : kCoreGap * core.radius);
      // What is in a wall may leave it.
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
      // Slower ones cannot lose touch with what they overlap at the end.
      if (flat::norm(t.shift) + std::abs(t.angle) * b.reach < 0.5 * b.inner) continue;
      const double f = first_stop(model, s, pairs, t, travels);
      if (f >= 1) continue;
      const Vec2 p = pairs.pose[t.body].p + f * t.shift;
      x[3 * t.body] = p.x, x[3 * t.body + 1] = p.y;
      // At its place already, it still turns, or it would stay in what it got into with a corner.
      if (f > 0) angle[t.body] -= (1 - f) * t.angle;
      // The time that it loses is lost for gravity too: what is put back up must not keep the fall's speed.
      const double fall = (1 - f) * h * model.dynamics[t.body].gravity_scale;
      v[3 * t.body] -= fall * g[0], v[3 * t.body + 1] -= fall * g[1];
    }
  });
}

void fall_asleep(const Model& model, State& s, const Pairs& pairs, const SleepRule& rule, double h,
                 std::vector<uint32_t>& parent, std::vector<double>& rested) {
  const size_t n = model.count();
  const auto status = s.span<uint32_t>(columns::status);
  const auto rest = s.f64(columns::rest), w = s.f64(columns::angular_velocity);
  double* v = s.f64(columns::velocity).data();
  double longest = 0;
  for (size_t i = 0; i < n; ++i) {
    const Light& b = model.light[i];
    if (!is_moved(b, status[i])) continue;
    const double slip = std::abs(w[i]) * b.reach, speed2 = v[3 * i] * v[3 * i] + v[3 * i + 1] * v[3 * i + 1];
    const bool slow = speed2 <= rule.speed * rule.speed && slip <= rule.speed;
    rest[i] = slow && b.can_sleep ? rest[i] + h : 0;
    longest = std::max(longest, rest[i]);
  }
  if (longest < rule.time) return;
  parent.resize(n);
  start_islands(parent);
  rested.assign(rest.begin(), rest.end());
  for (size_t i = 0; i < n; ++i) {
    if (!is_moved(model.light[i], status[i])) rested[i] = HUGE_VAL;
  }
  const auto join = [&](uint32_t a, uint32_t b) {
    const bool moved_a = a < n && is_moved(model.light[a], status[a]);
    const bool moved_b = b < n && is_moved(model.light[b], status[b]);
    if (moved_a && moved_b) return link_islands(parent, a, b);
    // A belt or lift keeps awake what it carries.
    const auto carries = [&](uint32_t i) {
      return pairs.active[i] || (i < n && model.surfaces[i].speed != 0);
    };
    if (moved_a && carries(b)) rested[a] = 0;
    if (moved_b && carries(a)) rested[b] = 0;
  };
  for (const uint32_t i : pairs.touching) join(pairs.hits[i].body_a, pairs.hits[i].body_b);
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  for (size_t j = 0; j < model.joints.size(); ++j) {
    const Joint& d = model.joints[j];
    if (broken[j]) continue;
    join(d.a, d.b);
    // A motor that wants to turn does not let its bodies sleep.
    if (d.has_motor && d.motor_speed != 0) {
      for (const uint32_t i : {d.a, d.b}) {
        if (i < n) rested[i] = 0;
      }
    }
  }
  spread_minimum<double>(parent, rested);
  for (size_t i = 0; i < n; ++i) {
    if (!is_moved(model.light[i], status[i]) || rested[i] < rule.time) continue;
    status[i] = 0;
    v[3 * i] = v[3 * i + 1] = 0, w[i] = 0;
  }
}

}  // namespace truestep::rigid2d
