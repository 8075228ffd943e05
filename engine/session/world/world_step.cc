// A step of a world: substeps of its systems between the two halves of its couplings. When points that are
// solved as a whole are tied to something else, each side is treated as linear in the other's impulses; a
// step that turns further than this is accurate for gains energy from nothing: links swing out along
// tangents, light points are flung away. Such a step is repeated in smaller parts, decided from the state at
// its start alone.
#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>

#include "engine/base/errors.h"
#include "engine/base/interrupt.h"
#include "engine/core/equations/impulse_answer.h"
#include "engine/session/world/immersed.h"
#include "engine/session/world/world.h"

namespace truestep {

namespace {

/// Rounds of every coupling's guard per substep, at most: guards that undo each other must end.
constexpr size_t kGuardRounds = 4;
/// What a step may add, as shares of the moving energy and of all that has been available: implicit methods
/// only lose. And the share of the latter by which the total may exceed that of the start before steps may
/// add the second only.
constexpr double kOfMotion = 1e-3, kOfAll = 1e-5, kTogether = 2e-3;
/// The same where forces move all points, whose energy swings within their method's accuracy.
constexpr double kSwung = 5e-3;
/// Numbers of parts tried, one after the other; each with a workspace of its own, which may depend on h.
struct Parts {
  uint64_t count;
  const char* memory;
};
constexpr std::array<Parts, 5> kParts{
    {{1, ""}, {4, "in 4 parts"}, {16, "in 16 parts"}, {64, "in 64 parts"}, {256, "in 256 parts"}}};
/// The most substeps and parts of a step together where points are put by constraints: steps of those have as
/// many substeps as they need from the start.
constexpr uint64_t kMostPieces = 4096;
constexpr double kFailed = std::numeric_limits<double>::infinity();
/// Subdividing that reduces the gain by less than this does not pay, unless it must: the total is above that
/// of the start.
constexpr double kWorthwhile = 0.5;

struct StepStart {
  std::vector<State> systems, couplings;
  std::vector<std::optional<Energy>> energy;
};

}  // namespace

namespace {

/// Whether the points of a system do not move by the sum of the forces on each: they are solved together, or
/// put where constraints hold. What others do to them is not part of that.
bool solves_alone(const System& system) {
  return answers_together(system) || (system.ports().points && !system.integration().method);
}

}  // namespace

void World::find_tied() {
  for (const SceneCoupling& c : scene_.couplings) {
    if (c.a == c.b) continue;
    const bool solved = solves_alone(*systems_[c.a]) || solves_alone(*systems_[c.b]);
    auto group = std::ranges::find(tied_, joined_to_[c.a], &Tied::first);
    if (group == tied_.end()) group = tied_.insert(group, {joined_to_[c.a], Tied::Points::by_forces});
    if (solved) group->points = Tied::Points::solved;
  }
  if (tied_.empty()) return;
  if (substeps_of_pressed() > 1)
    most_parts_ = std::max(uint64_t{1}, kMostPieces / static_cast<uint64_t>(scene_.substeps()));
  const WorldState start = initial_state();
  // Liquids exchange momentum with bodies by the parcel, and steps of theirs are dear: they are not repeated.
  const auto holds_medium = [&](const Tied& t) {
    for (size_t i = 0; i < systems_.size(); ++i) {
      if (joined_to_[i] == t.first && systems_[i]->ports().medium) return true;
    }
    return false;
  };
  std::erase_if(tied_, [&](Tied& t) {
    const auto e = energy(start, t.first);
    if (e) t.start = e->kinetic + e->potential;
    return holds_medium(t) || !e;
  });
}

void World::substeps(WorldState& state, const Pace& pace, Workspace& workspace, const ThreadArena& arena,
                     std::span<Profile> profiles) const {
  const double h = pace.h;
  const auto named = [&](size_t i, auto&& body) {
    try {
      body();
      if (const auto bad = state.systems[i].first_bad(speed_limits_[i])) reject(i, state.systems[i], *bad);
    } catch (Instability& e) {
      e.system = id(i);
      e.step = static_cast<long long>(state.step);
      throw;
    }
  };
  for (uint64_t n = pace.first; n < pace.first + pace.count; ++n) {
    interruption_point();
    const auto input = [&](const std::string& name, size_t profile) -> StepInput {
      return {static_cast<double>(n) * h,        h,     n,
              workspace.object<Workspace>(name), arena, profiles.empty() ? nullptr : &profiles[profile]};
    };
    const auto coupling_input = [&](size_t c) { return input(scene_.couplings[c].id, size() + c); };
    for (size_t c = 0; c < couplings_.size(); ++c) couplings_[c]->begin(sides(state, c), coupling_input(c));
    auto& immersed = workspace.object<Immersed>("immersed");
    if (!couplings_.empty()) {
      immersed.gather(systems_.size(), couplings_.size(), [&](size_t c, std::vector<ImmersedBody>& out) {
        couplings_[c]->immerse(sides(std::as_const(state), c), coupling_input(c), out);
        return scene_.couplings[c].b;
      });
    }
    for (size_t i = 0; i < systems_.size(); ++i) {
      named(i, [&] {
        StepInput in = input(id(i), i);
        if (!couplings_.empty()) in.bodies = immersed.of(i);
        systems_[i]->step(state.systems[i], in);
      });
    }
    for (size_t c = 0; c < couplings_.size(); ++c) couplings_[c]->midway(sides(state, c), coupling_input(c));
    for (size_t c = couplings_.size(); c-- > 0;) {
      couplings_[c]->emerge(sides(state, c), coupling_input(c), immersed.by(c));
      couplings_[c]->end(sides(state, c), coupling_input(c));
    }
    // A change by one guard must be checked by all others.
    const size_t n_couplings = couplings_.size(), most = kGuardRounds * n_couplings;
    for (size_t quiet = 0, turn = 0; quiet < n_couplings && turn < most; ++turn) {
      const size_t c = turn % n_couplings;
      quiet = couplings_[c]->guard(sides(state, c), coupling_input(c)) ? 1 : quiet + 1;
    }
  }
  if (couplings_.empty()) return;
  for (size_t i = 0; i < systems_.size(); ++i) named(i, [] {});
}

World::Gain World::gained(const WorldState& state, std::span<const std::optional<Energy>> before, double t,
                          Workspace& workspace, const ThreadArena& arena) const {
  Gain out;
  for (size_t g = 0; g < tied_.size(); ++g) {
    if (!before[g]) continue;
    const size_t i = tied_[g].first;
    const auto now = energy_together(state, i, t, workspace, arena);
    if (!now || now->exchange == Energy::Exchange::open) continue;
    const Energy& then = *before[g];
    const double rise = (now->kinetic + now->potential) - (then.kinetic + then.potential);
    const EnergyWatch& watch = state.watch[i];
    const bool by_forces = tied_[g].points == Tied::Points::by_forces;
    const double more = (by_forces ? kSwung : kTogether) * watch.available;
    const bool above = now->kinetic + now->potential > watch.reference + more;
    if (!above && by_forces) continue;
    const double allowed = (above ? 0 : kOfMotion * std::max(then.kinetic, now->kinetic)) +
                           kOfAll * std::max(watch.available, now->slack);
    if (!std::isfinite(rise)) return {.times = kFailed};
    if (!(rise > allowed)) continue;
    out.times = std::max(out.times, rise / allowed);
    if (above) out.total = Gain::Total::above_start;
  }
  return out;
}

void World::substeps_of_tied(WorldState& state, const Pace& pace, Workspace& workspace,
                             const ThreadArena& arena, std::span<Profile> profiles) const {
  auto& start = workspace.object<StepStart>("start");
  const double t = static_cast<double>(state.step) * dt();
  start.energy.clear();
  bool closed = false;
  for (const Tied& tied : tied_) {
    auto e = energy_together(state, tied.first, t, workspace, arena);
    if (e && e->exchange == Energy::Exchange::open) e.reset();
    closed |= e.has_value();
    start.energy.push_back(e);
  }
  if (!closed) return substeps(state, pace, workspace, arena, profiles);
  start.systems = state.systems, start.couplings = state.couplings;
  std::exception_ptr failure;
  const auto attempt = [&](const Parts& parts) -> Gain {
    const bool whole = parts.count == 1;
    const Pace finer{pace.h / static_cast<double>(parts.count), pace.first * parts.count,
                     pace.count * parts.count};
    try {
      substeps(state, finer, whole ? workspace : workspace.object<Workspace>(parts.memory), arena, profiles);
      return gained(state, start.energy, t + dt(), workspace, arena);
    } catch (const Instability&) {
      if (!failure) failure = std::current_exception();
      return {.times = kFailed};
    }
  };
  const auto restart = [&] { state.systems = start.systems, state.couplings = start.couplings; };
  const Parts *best = nullptr, *last = nullptr;
  double least = kFailed;
  for (const Parts& parts : kParts) {
    if (parts.count > most_parts_) break;
    if (last) restart();
    last = &parts;
    const Gain gain = attempt(parts);
    if (gain.times == 0) return;
    const double before = least;
    if (gain.times < least) least = gain.times, best = &parts;
    if (before < kFailed && gain.times > kWorthwhile * before && gain.total == Gain::Total::within) break;
  }
  if (!best && failure) std::rethrow_exception(failure);
  if (!best) return;  // not finite, which the checks after the step say
  if (best != last) restart(), attempt(*best);
}

void World::watch_tied(WorldState& state, Workspace& workspace, const ThreadArena& arena) const {
  for (const Tied& tied : tied_) {
    if (state.watch[tied.first].phase != EnergyWatch::Phase::watching) continue;
    try {
      watch_energy(state, tied.first, static_cast<double>(state.step + 1) * dt(), workspace, arena);
    } catch (Instability& e) {
      e.step = static_cast<long long>(state.step);
      throw;
    }
  }
}

void World::step(WorldState& state, Workspace& workspace, const ThreadArena& arena,
                 std::span<Profile> profiles) const {
  if (state.watch.size() != systems_.size()) {
    state.watch.assign(systems_.size(), {});
    look(state, state.step, workspace, arena);
  }
  const auto count = static_cast<uint64_t>(scene_.substeps());
  const Pace pace{scene_.substep(), state.step * count, count};
  if (tied_.empty()) {
    substeps(state, pace, workspace, arena, profiles);
  } else {
    substeps_of_tied(state, pace, workspace, arena, profiles);
  }
  if (watched(state.step + 1)) {
    look(state, state.step + 1, workspace, arena);
  } else {
    watch_tied(state, workspace, arena);
  }
  if (finer_) finer_->step(state.finer.at(0), workspace.object<Workspace>("finer"), arena, {});
  ++state.step;
}

}  // namespace truestep
