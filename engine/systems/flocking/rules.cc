// The steps of the three rules, and of predators. Everyone gathers from the neighbours in the order of the
// sorted cells, which is a function of the positions alone.
#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "engine/kernels/flocking/steering.h"
#include "engine/systems/flocking/flocking.h"
#include "engine/systems/flocking/gather.h"

namespace truestep::flocking {
namespace {

constexpr size_t kBlock = 256;
constexpr double kHalfTurn = 3.141592653589793;
/// Lower streams of random numbers belong to the initial state.
constexpr uint64_t kFirstRow = 2;

double weight(const State& s, Weight w) {
  return s.f64(Columns::weights)[static_cast<size_t>(w)];
}

}  // namespace

Vec3 Flocking::avoidance(const State& s, const Vec3& x, const Vec3& heading, double t) const {
  Vec3 a;
  if (box_.sides == Sides::walls) {
    const auto away = [this](double at, double low, double high) {
      const double near_low = std::max(0.0, 1 - (at - low) / def_.wall_margin);
      const double near_high = std::max(0.0, 1 - (high - at) / def_.wall_margin);
      return def_.wall_strength * (near_low - near_high);
    };
    a.x = away(x.x, box_.low.x, box_.high.x), a.y = away(x.y, box_.low.y, box_.high.y);
    if (!box_.plane) a.z = away(x.z, box_.low.z, box_.high.z);
  }
  if (!colliders_.empty()) {
    const NearSurface near = colliders_.nearest(x, t);
    const double push = def_.wall_strength * std::max(0.0, 1 - near.distance / def_.wall_margin);
    const double into = dot(heading, near.normal);
    // A member heading for the surface is also turned aside along it: a push outwards alone would only stop
    // it.
    if (push > 0 && into < 0)
      a += normalized(heading - near.normal * into, perpendicular(near.normal)) * push;
    a += near.normal * push;
    if (box_.plane) a.z = 0;
  }
  const double to_goal = weight(s, Weight::goal_strength);
  if (to_goal > 0) a += normalized(load3(s.f64(Columns::goal).data(), 0) - x, Vec3{}) * to_goal;
  const double* all = s.f64(Columns::position).data();
  for (size_t p = boids_; p < rows_; ++p) {
    const Vec3 d = x - load3(all, p);
    a += separation(d, norm(d), def_.flight_radius) * def_.flight_strength;
  }
  return a;
}

void Flocking::steer(State& s, const StepInput& in) const {
  double *x = s.f64(Columns::position).data(), *v = s.f64(Columns::velocity).data();
  auto& sorted = in.workspace.object<Sorted>("flocking.sorted");
  sorted.build_wide(x, v, boids_, reach_, in.arena);
  const double apart = weight(s, Weight::separation), along = weight(s, Weight::alignment),
               joined = weight(s, Weight::cohesion);
  const Sight sight{.reach2 = reach_ * reach_,
                    .align2 = def_.alignment_radius * def_.alignment_radius,
                    .join2 = def_.cohesion_radius * def_.cohesion_radius,
                    .apart = def_.separation_radius,
                    .cos_view = cos_view_,
                    .field = def_.view_angle >= 2 * kHalfTurn ? Sight::Field::all : Sight::Field::cone};
  const trig::SinCos turn = trig::sincos(std::min(kHalfTurn, def_.max_turn_rate * in.h));
  auto a = in.workspace.doubles("flocking.acceleration", 3 * boids_);
  in.arena.for_blocks(sorted.grid.size(), kBlock, [&](size_t begin, size_t end) {
    Gather g(sorted, sight);
    for (size_t slot = begin; slot < end; ++slot) {
      const Vec3 at = sorted.grid.position(slot);
      const double* v4 = &sorted.v4[4 * slot];
      const Vec3 heading = normalized(Vec3{v4[0], v4[1], v4[2]}, Vec3{});
      g.begin(slot, heading);
      box_.images(at, reach_, [&](const Vec3& shift) {
        const Vec3 p = at + shift;
        if (!(shift == Vec3{})) g.look_from(p);
        sorted.grid.near(p, [&](size_t from, size_t to) { g.add(p, from, to); });
      });
      g.finish();
      Vec3 sum = g.away * apart + avoidance(s, at, heading, in.t);
      if (g.with > 0) sum += g.mean_v * (along / g.with);
      if (g.near > 0) sum += g.mean_x * (joined / g.near);
      const double size = norm(sum);
      store3(a.data(), sorted.grid.point(slot),
             size > def_.max_acceleration ? sum * (def_.max_acceleration / size) : sum);
    }
  });
  in.arena.for_blocks(boids_, kBlock, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 before = load3(v, i), after = before + load3<double>(a.data(), i) * in.h;
      const Vec3 from = normalized(before, normalized(after));
      const Vec3 to = turn_towards(from, normalized(after, from), turn);
      const Vec3 u = to * std::clamp(norm(after), def_.min_speed, def_.max_speed);
      store3(v, i, u), store3(x, i, load3(x, i) + u * in.h);
      hold(x, v, i);
    }
  });
}

void Flocking::align(State& s, const StepInput& in) const {
  double *x = s.f64(Columns::position).data(), *v = s.f64(Columns::velocity).data();
  auto& sorted = in.workspace.object<Sorted>("flocking.sorted");
  sorted.build(x, v, boids_, reach_, in.arena);
  const double noise = weight(s, Weight::noise), r2 = reach_ * reach_;
  in.arena.for_blocks(sorted.grid.size(), kBlock, [&](size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; ++slot) {
      const size_t i = sorted.grid.point(slot);
      const Vec3 at = sorted.grid.position(slot), u = load3(sorted.v.data(), slot);
      Vec3 sum;
      box_.images(at, reach_, [&](const Vec3& shift) {
        const Vec3 p = at + shift;
        sorted.grid.near(p, [&](size_t from, size_t to) {
          for (size_t q = from; q < to; ++q) {
            if (norm2(sorted.grid.position(q) - p) <= r2) sum += load3(sorted.v.data(), q);
          }
        });
      });
      const Vec3 mean = normalized(sum, normalized(u));
      const Vec3 heading = disturbed(mean, noise, box_.plane, uniform4(seed_, kFirstRow + i, in.step));
      store3(x, i, at + u * in.h), store3(v, i, heading * def_.speed);
      hold(x, v, i);
    }
  });
}

void Flocking::approach(State& s, const StepInput& in) const {
  const size_t n = 3 * boids_;
  double *x = s.f64(Columns::position).data(), *v = s.f64(Columns::velocity).data();
  auto memory = in.workspace.doubles("flocking.stages", 5 * n);
  double *xs = memory.data(), *vs = xs + n, *a = vs + n, *sum_v = a + n, *sum_a = sum_v + n;
  const double k = weight(s, Weight::coupling) / static_cast<double>(boids_);
  const auto accelerate = [&] {
    Vec3 total;
    for (size_t j = 0; j < boids_; ++j) total += load3<double>(vs, j);
    in.arena.for_blocks(boids_, kBlock, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const Vec3 at = load3<double>(xs, i), u = load3<double>(vs, i);
        Vec3 sum = total - u * static_cast<double>(boids_);
        if (def_.decay > 0) {
          sum = {};
          for (size_t j = 0; j < boids_; ++j) {
            const double w = influence(norm2(load3<double>(xs, j) - at), def_.influence_range, def_.decay);
            sum += (load3<double>(vs, j) - u) * w;
          }
        }
        store3(a, i, sum * k);
      }
    });
  };
  // The classical method of order 4 on (x, v); `share`: position of a stage in the step.
  constexpr double kShare[4] = {0, 0.5, 0.5, 1}, kWeight[4] = {1, 2, 2, 1};
  std::fill_n(sum_v, 2 * n, 0.0);
  std::fill_n(a, n, 0.0), std::copy_n(v, n, vs);
  for (int stage = 0; stage < 4; ++stage) {
    for (size_t c = 0; c < n; ++c) {
      xs[c] = x[c] + kShare[stage] * in.h * vs[c];
      vs[c] = v[c] + kShare[stage] * in.h * a[c];
    }
    accelerate();
    for (size_t c = 0; c < n; ++c) sum_v[c] += kWeight[stage] * vs[c], sum_a[c] += kWeight[stage] * a[c];
  }
  for (size_t c = 0; c < n; ++c) x[c] += in.h / 6 * sum_v[c], v[c] += in.h / 6 * sum_a[c];
}

void Flocking::chase(State& s, const StepInput& in) const {
  double *x = s.f64(Columns::position).data(), *v = s.f64(Columns::velocity).data();
  const trig::SinCos turn = trig::sincos(std::min(kHalfTurn, def_.predator_turn_rate * in.h));
  for (size_t p = boids_; p < rows_; ++p) {
    const Vec3 at = load3(x, p), from = normalized(load3(v, p));
    Vec3 prey;
    double nearest = HUGE_VAL;
    for (size_t i = 0; i < boids_; ++i) {
      const Vec3 d = load3(x, i) - at;
      if (norm2(d) < nearest) nearest = norm2(d), prey = d;
    }
    const Vec3 u = turn_towards(from, normalized(prey, from), turn) * def_.predator_speed;
    store3(v, p, u), store3(x, p, at + u * in.h);
    hold(x, v, p);
  }
}

}  // namespace truestep::flocking
