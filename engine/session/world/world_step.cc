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
/// only lose.
constexpr double kOfMotion = 1e-3, kOfAll = 1e-5;
/// Numbers of parts tried, one after the other; each with a workspace of its own, which may depend on h.
struct Parts {
  uint64_t count;
  const char* memory;
};
constexpr std::array<Parts, 3> kParts{{{4, "in 4 parts"}, {16, "in 16 parts"}, {64, "in 64 parts"}}};
/// Subdividing that reduces the gain by less than this does not pay.
constexpr double kWorthwhile = 0.5;

struct StepStart {
  std::vector<State> systems, couplings;
  std::vector<std::optional<Energy>> energy;
};

}  // namespace

void World::find_tied() {
  for (const SceneCoupling& c : scene_.couplings) {
    const size_t first = joined_to_[c.a];
    if (answers_together(*systems_[c.a]) || answers_together(*systems_[c.b])) {
      if (std::ranges::find(tied_, first) == tied_.end()) tied_.push_back(first);
    }
  }
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

double World::gained(const WorldState& state, std::span<const std::optional<Energy>> before, double t,
                     Workspace& workspace, const ThreadArena& arena) const {
  double most = 0;
  for (size_t g = 0; g < tied_.size(); ++g) {
    if (!before[g]) continue;
    const size_t i = tied_[g];
    const auto now = energy_together(state, i, t, workspace, arena);
    if (!now || now->exchange == Energy::Exchange::open) continue;
    const Energy& then = *before[g];
    const double rise = (now->kinetic + now->potential) - (then.kinetic + then.potential);
    const double allowed = kOfMotion * std::max(then.kinetic, now->kinetic) +
                           kOfAll * std::max(state.watch[i].available, now->slack);
    if (!std::isfinite(rise)) return std::numeric_limits<double>::infinity();
    if (rise > allowed) most = std::max(most, rise / allowed);
  }
  return most;
}

void World::substeps_of_tied(WorldState& state, const Pace& pace, Workspace& workspace,
                             const ThreadArena& arena, std::span<Profile> profiles) const {
  auto& start = workspace.object<StepStart>("start");
  const double t = static_cast<double>(state.step) * dt();
  start.energy.clear();
  bool closed = false;
  for (const size_t i : tied_) {
    auto e = energy_together(state, i, t, workspace, arena);
    if (e && e->exchange == Energy::Exchange::open) e.reset();
    closed |= e.has_value();
    start.energy.push_back(e);
  }
  if (!closed) return substeps(state, pace, workspace, arena, profiles);
  start.systems = state.systems, start.couplings = state.couplings;
  const auto restart = [&] { state.systems = start.systems, state.couplings = start.couplings; };
  const auto take = [&](const Pace& p, Workspace& memory) {
    substeps(state, p, memory, arena, profiles);
    return gained(state, start.energy, t + dt(), workspace, arena);
  };
  constexpr double kFailed = std::numeric_limits<double>::infinity();
  double gain = kFailed;
  std::exception_ptr failure;
  try {
    gain = take(pace, workspace);
  } catch (const Instability&) {
    failure = std::current_exception();
  }
  for (const Parts& parts : kParts) {
    if (gain == 0) return;
    const Pace finer{pace.h / static_cast<double>(parts.count), pace.first * parts.count,
                     pace.count * parts.count};
    restart();
    double less = kFailed;
    try {
      less = take(finer, workspace.object<Workspace>(parts.memory));
    } catch (const Instability&) {
      if (!failure) failure = std::current_exception();
    }
    if (gain < kFailed && less > kWorthwhile * gain) break;
    gain = less;
  }
  if (gain == kFailed && failure) std::rethrow_exception(failure);
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
  if (watched(state.step + 1)) look(state, state.step + 1, workspace, arena);
  if (finer_) finer_->step(state.finer.at(0), workspace.object<Workspace>("finer"), arena, {});
  ++state.step;
}

}  // namespace truestep
