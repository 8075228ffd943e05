#include "engine/studies/stability_trial.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/errors.h"
#include "engine/base/random.h"
#include "engine/integrators/table/integrators.h"
#include "engine/studies/scene_variant.h"
#include "engine/studies/trajectory.h"

namespace truestep {

namespace json = boost::json;

namespace {

double largest_move(std::span<const double> x, const std::vector<double>& from) {
  if (x.size() != from.size()) return 0;
  double most = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    const double d = std::abs(x[i] - from[i]);
    if (!(d <= most)) most = d;  // NaN counts as largest
  }
  return most;
}

double scale(const std::vector<double>& x) {
  double most = 1e-3;
  for (const double c : x) most = std::max(most, std::abs(c));
  return most;
}

double total(const Energy& e) {
  return e.kinetic + e.potential;
}

}  // namespace

void StabilityTrial::set_steps(int64_t steps) {
  steps_ = steps;
  reaches_.clear();
  runs_ = 0;
}

/// Empty where it is unknown, or other things give and take it.
std::optional<Energy> StabilityTrial::energy(const World& world, const WorldState& state,
                                             Workspace& workspace) const {
  static const ThreadArena kSerial(1);
  if (!world.couplings().empty()) return std::nullopt;
  const double t = static_cast<double>(state.step) * world.dt();
  auto e = world.system(system_).energy(state.systems[system_], t, workspace, kSerial);
  if (e && e->exchange == Energy::Exchange::open) e.reset();
  return e;
}

bool StabilityTrial::stable(double dt) {
  ++runs_;
  json::value d = scene_;
  set_dt(d, dt);
  set_integrator(d, system_, method_);
  std::optional<World> built;
  try {
    built.emplace(require_scene(read_scene(d)));
  } catch (const Error& e) {
    // Long steps are refused with a pointer; faults that shorter steps share are left to the caller.
    if (e.code() != "scene_invalid" || runs_ < 3) throw;
    throw TooLong{};
  }
  const World& world = *built;
  WorldState state = world.initial_state();
  State& s = state.systems[system_];
  const auto x = s.at("position");
  const std::vector<double> start(s.f64(x).begin(), s.f64(x).end());
  disturb(s);
  Workspace workspace;
  const auto before = energy(world, state, workspace);
  const double bound = 10 * std::max(reach(dt, start), 1e-6 * scale(start));
  const double begin = thread_cpu_seconds();
  const Integrator* method = find_integrator(method_);
  const bool solves = before && method && method->kind != Integrator::Kind::explicit_;
  WorldState last;
  try {
    for (int64_t n = 0; n < steps_; ++n) {
      if (solves) last = state;
      if (n % 64 == 0) context_.check();
      if (thread_cpu_seconds() > stop_at_) throw OverBudget{};
      step(world, state, workspace);
      if (largest_move(state.systems[system_].f64(x), start) <= bound) continue;
      const auto now = before ? energy(world, state, workspace) : std::nullopt;
      if (!now || !(total(*now) - total(*before) <= at_work_)) return false;
    }
  } catch (const Instability&) {
    // Equations of a step that were not solved show no growth; energy does.
    const auto now = solves ? energy(world, last, workspace) : std::nullopt;
    if (!now || !(total(*now) - total(*before) <= at_work_)) return false;
    unsolved_ = true;
  }
  stepping_ = thread_cpu_seconds() - begin;
  return true;
}

// Uncoupled systems are skipped: they say nothing about this one.
void StabilityTrial::step(const World& world, WorldState& state, Workspace& workspace) const {
  static const ThreadArena kSerial(1);
  if (!world.couplings().empty()) return world.step(state, workspace, kSerial, {});
  const double h = world.scene().substep();
  const auto substeps = static_cast<uint64_t>(world.scene().substeps());
  for (uint64_t k = 0, n = state.step * substeps; k < substeps; ++k, ++n) {
    world.system(system_).step(
        state.systems[system_],
        {.t = static_cast<double>(n) * h, .h = h, .step = n, .workspace = workspace, .arena = kSerial});
  }
  ++state.step;
}

// A small push on every velocity gives an unstable mode something to grow from.
void StabilityTrial::disturb(State& s) const {
  const auto v = s.f64(s.at("velocity"));
  const auto x = s.f64(s.at("position"));
  const double size = 1e-7 * scale({x.begin(), x.end()});
  for (size_t i = 0; i < v.size(); ++i) v[i] += size * (uniform4(11, 0, i)[0] - 0.5);
}

// How far the motion gets in the time of `steps` steps of dt, from one run at a small step.
double StabilityTrial::reach(double dt, const std::vector<double>& start) {
  const double horizon = dt * static_cast<double>(steps_);
  if (reaches_.empty()) follow(start);
  double most = 0, half = 0;
  const double end = reaches_.back().first;
  for (const auto& [t, distance] : reaches_) {
    if (t <= horizon || most == 0) most = std::max(most, distance);
    if (t <= 0.5 * end) half = std::max(half, distance);
  }
  // Longer than the reference: what still drifts there goes on as freely moving or falling bodies do.
  const double longer = horizon / end;
  return longer > 1 && most > 1.5 * half ? most * longer * longer : most;
}

// The reference motion: the scene's own method at its own step.
void StabilityTrial::follow(const std::vector<double>& start) {
  const World world = build_world(scene_, context_);
  WorldState state = world.initial_state();
  Workspace workspace;
  double most = 0, swing = 0, least = 0, greatest = 0;
  const auto weigh = [&](bool first) {
    const auto e = energy(world, state, workspace);
    if (!e) return;
    swing = std::max(swing, e->kinetic);
    least = first ? e->potential : std::min(least, e->potential);
    greatest = first ? e->potential : std::max(greatest, e->potential);
  };
  weigh(true);
  try {
    for (int64_t n = 0; n < steps_ && thread_cpu_seconds() < stop_at_; ++n) {
      context_.check();
      step(world, state, workspace);
      weigh(false);
      most = std::max(most,
                      largest_move(state.systems[system_].f64(state.systems[system_].at("position")), start));
      reaches_.emplace_back(static_cast<double>(n + 1) * world.dt(), most);
    }
  } catch (const Instability&) {
    // Compared with the motion up to there.
  }
  if (reaches_.empty()) reaches_.emplace_back(0, most);
  at_work_ = swing + greatest - least;
}

}  // namespace truestep
