#include "engine/session/remedies.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/interrupt.h"
#include "engine/base/text/short_number.h"
#include "engine/base/thread_clock.h"
#include "engine/integrators/table/integrators.h"
#include "engine/scene/admission.h"

namespace truestep {

namespace {

namespace json = boost::json;

/// Estimated time of one trial; only a few are made.
constexpr double kTrialSeconds = 0.5;
/// CPU s of all trials together: steps of a scene that fails may cost far more than estimated.
constexpr double kMostSeconds = 10;
constexpr int64_t kMostParts = 4096;  // substeps worth a trial
constexpr size_t kMostMethods = 3;    // tried of each kind

bool unlimited(const Integrator& row, const Integration& s) {
  return std::isinf(stability_interval(row, *s.options).imaginary);
}

/// The change that a trial makes in the system that failed.
using Change = std::function<void(json::object&)>;
Change method_of(std::string_view name) {
  return [name](json::object& system) { system["integrator"] = name; };
}

// Systems without a force field that take a method: methods that choose their own steps, and a tolerance that
// more of them meet; kLoose if the scene gives none.
constexpr const char* kOwnSteps[] = {"tsit5", "dop853", "radau5", "rodas5p"};
constexpr double kLooser = 1000, kLoose = 1e-5;
void loosen(json::object& system) {
  bool said = false;
  for (const char* name : {"tolerance", "relative_tolerance", "absolute_tolerance"}) {
    json::value* v = system.if_contains(name);
    if (v && v->is_number()) *v = kLooser * v->to_number<double>(), said = true;
  }
  if (!said) system["tolerance"] = kLoose;
}

// Methods that are stable at any step or choose their own, in the order in which they are worth a trial.
std::vector<const Integrator*> other_methods(const Integration& s) {
  using Kind = Integrator::Kind;
  using Stepping = Integrator::Stepping;
  std::vector<const Integrator*> out;
  const auto add = [&](Kind kind, Stepping stepping) {
    size_t found = 0;
    for (const Integrator& row : integrators()) {
      if (&row == s.method || row.kind != kind || row.stepping != stepping || !row.step) continue;
      if (found == kMostMethods || row.name.starts_with("cvode")) continue;
      if (kind == Kind::implicit && stepping == Stepping::fixed && !unlimited(row, s)) continue;
      if (refusal(row, *s.field)) continue;
      out.push_back(&row), ++found;
    }
  };
  add(Kind::implicit, Stepping::fixed);
  add(Kind::explicit_, Stepping::adaptive);
  add(Kind::implicit, Stepping::adaptive);
  return out;
}

class Trials {
 public:
  Trials(const World& world, const WorldState& before, uint64_t failed, const Commands& commands,
         const ThreadArena& arena)
      : world_(world), before_(before), commands_(commands), arena_(arena) {
    const uint64_t until = failed + 1 - before.step;
    steps_ = until + std::min(kTrialAfter, trial_steps_before(world));
  }
  uint64_t steps() const { return steps_; }

  /// Whether the time for trials is used up; remaining ones are skipped.
  bool spent() const { return thread_cpu_seconds() - began_ > kMostSeconds; }

  /// Whether the scene, with this many substeps and optionally a change in one of its systems, gets from
  /// `before` to the end of the trial.
  bool holds(int64_t substeps, size_t system = 0, const Change& change = {}) {
    json::object d = world_.scene().canonical();
    d.erase("accuracy");
    d["time"].as_object()["substeps"] = substeps;
    if (change) change(d["systems"].as_array()[system].as_object());
    if (spent()) return false;
    try {
      const World changed(require_scene(read_scene(d)));
      WorldState state = begin(changed);
      Workspace workspace;
      for (uint64_t n = 0; n < steps_; ++n) {
        if (spent()) return false;
        if (n > 0) commands_(changed, state);
        changed.step(state, workspace, arena_, {});
      }
      // Energy that has crept up since the last check shows here.
      state.watch.clear();
      changed.step(state, workspace, arena_, {});
    } catch (const Interrupted&) {
      throw;
    } catch (const Error&) {
      return false;
    }
    return true;
  }

 private:
  // The states of `before`; columns that belong to a method start afresh where the methods differ.
  WorldState begin(const World& changed) const {
    WorldState state = changed.initial_state();
    state.step = before_.step;
    state.couplings = before_.couplings;
    state.watch = before_.watch;
    for (size_t i = 0; i < state.systems.size(); ++i) {
      State& to = state.systems[i];
      const State& from = before_.systems[i];
      for (State::Column c = 0; c < to.columns(); ++c) {
        const auto there = from.find(to.info(c).name);
        if (!there || !(from.info(*there) == to.info(c))) continue;
        const bool of_method = to.info(c).name.starts_with("integrator.");
        if (of_method && from.rows(*there) != to.rows(c)) continue;
        to.copy_column(c, from, *there);
      }
    }
    return state;
  }

  const World& world_;
  const WorldState& before_;
  const Commands& commands_;
  const ThreadArena& arena_;
  const double began_ = thread_cpu_seconds();
  uint64_t steps_;
};

}  // namespace

uint64_t trial_steps_before(const World& world) {
  const double each = std::max(estimate(world.scene()).seconds_per_step, 1e-9);
  return static_cast<uint64_t>(std::clamp(kTrialSeconds / each, 8.0, double{kTrialBefore}));
}

Remedies try_remedies(const World& world, const WorldState& before, uint64_t failed,
                      const std::string& system, std::optional<double> hint, const Commands& commands,
                      const ThreadArena& arena) {
  Remedies out;
  Trials trials(world, before, failed, commands, arena);
  const double dt = world.dt(), each = std::max(estimate(world.scene()).seconds_per_step, 1e-9);
  const int64_t substeps = world.scene().substeps();
  const std::string tried = " (held when tried for " + std::to_string(trials.steps()) + " steps)";

  // Smaller steps: what theory expects to be stable, a tenth less (at the limit itself errors may still grow
  // linearly), or half; then ever smaller.
  const double most =
      std::min(static_cast<double>(kMostParts),
               std::max(8.0, 16 * kTrialSeconds / (each * static_cast<double>(trials.steps()))));
  const bool expected = hint && *hint > 0 && *hint < dt;
  std::vector<double> divisions;
  if (expected) divisions = {std::ceil(dt / *hint), std::ceil(1.1 * dt / *hint)};
  for (double parts = expected ? 4 * divisions[0] : 2; parts <= most; parts *= 4) divisions.push_back(parts);
  for (const double parts : divisions) {
    if (!(parts <= most)) continue;
    const int64_t finer = static_cast<int64_t>(parts) * substeps;
    if (!trials.holds(finer)) continue;
    out.dt = dt / parts;
    out.sentences.push_back("a step of " + short_number(*out.dt, 4) + " s, or " + std::to_string(finer) +
                            " substeps of the present step" + tried);
    break;
  }
  const size_t index = world.index_of(system);
  if (const Integration own = world.system(index).integration(); own.field) {
    for (const Integrator* method : other_methods(own)) {
      if (!trials.holds(substeps, index, method_of(method->name))) continue;
      out.sentences.push_back("the integrator " + std::string(method->name) + " (" +
                              std::string(method->title) + ")" + tried);
      break;
    }
  } else if (world.scene().systems[index].row->table->find("integrator")) {
    for (const char* name : kOwnSteps) {
      if (!trials.holds(substeps, index, method_of(name))) continue;
      out.sentences.push_back("the integrator " + std::string(name) + tried);
      break;
    }
    if (trials.holds(substeps, index, loosen)) {
      out.sentences.push_back("a tolerance " + short_number(kLooser, 4) + " times as large" + tried);
    }
  }
  if (out.sentences.empty()) {
    out.sentences = world.system(index).remedies();
    if (!out.sentences.empty()) out.sentences.back() += " (no smaller step that was tried held)";
  }
  if (out.sentences.empty()) {
    out.sentences.push_back(
        "softer forces: lower stiffness, more mass or more damping (no smaller step and no other method that "
        "was tried held)");
  }
  return out;
}

}  // namespace truestep
