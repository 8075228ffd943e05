// A world: the systems of a scene, what they do to each other, their clock and the plan of a step. Immutable;
// the state travels outside. Time is step * dt, and substep k of step n starts at (n * substeps + k) * h.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "engine/core/coupling.h"
#include "engine/core/system.h"
#include "engine/scene/scene.h"
#include "engine/session/part_table.h"
#include "engine/session/references.h"

namespace truestep {

/// Steps that a number of JSON counts exactly.
inline constexpr uint64_t kMostStep = 9'000'000'000'000'000;

/// The states of all systems and couplings at the end of step `step`.
struct WorldState {
  uint64_t step = 0;
  std::vector<State> systems;
  std::vector<State> couplings;
  std::vector<WorldState> finer;   ///< the companion that errors are estimated with: one, or none
  std::vector<EnergyWatch> watch;  ///< per system, from its first step on

  /// Of everything but the watch, which moves nothing.
  uint64_t hash() const;
  friend bool operator==(const WorldState&, const WorldState&) = default;
  /// Little-endian bytes, read back by deserialize (Error "bad_snapshot").
  std::vector<std::byte> serialize() const;
  static WorldState deserialize(std::span<const std::byte> bytes);
  size_t memory_bytes() const;

 private:
  enum class Companion : uint8_t { none, allowed };
  static WorldState read(std::span<const std::byte> bytes, Companion companion);
};

class World {
 public:
  /// Builds every system and coupling. Error "scene_invalid" with pointers below /systems/<i> and
  /// /couplings/<i> where one refuses.
  explicit World(Scene scene);
  /// Faults of a report's draft beside those that reading found: all of it that is sound is built for them.
  static std::vector<Issue> more_faults(const SceneReport& report);

  const Scene& scene() const { return scene_; }
  double dt() const { return scene_.header.time.dt; }
  size_t size() const { return systems_.size(); }
  const System& system(size_t i) const { return *systems_[i]; }
  const std::string& id(size_t i) const { return scene_.systems[i].id; }
  /// What there is to stream, record, draw and probe: the parts of all systems, in their order.
  const PartTable& parts() const { return parts_; }
  FieldView field(const WorldState& state, const FieldPlace& at, std::vector<double>& scratch) const {
    return parts_[at.part].field(state.systems[parts_[at.part].system], at.field, scratch);
  }
  /// What is wished for of all systems; with Wish::constant one PartDrawing per part of the world.
  void draw(const WorldState& state, Wish wishes, Drawing& out) const;
  uint32_t drawing_version(const WorldState& state) const;
  const std::vector<std::unique_ptr<const Coupling>>& couplings() const { return couplings_; }
  /// Index of the system with this id; Error "unknown_system" naming those there are.
  size_t index_of(std::string_view id) const;

  /// Error "scene_invalid" when a number of it is beyond what its type holds.
  WorldState initial_state() const;
  /// Error "bad_snapshot" unless a state from outside can be stepped: the columns of this world's states,
  /// rows that belong together, finite numbers.
  void require_state(const WorldState& state) const;
  /// Of everything in the scene that moves something: two scenes with the same one continue a state alike.
  uint64_t fingerprint() const;
  /// Error "scene_invalid" when a state that nothing has happened to has more energy than a number holds.
  void require_finite_energy(const WorldState& state) const;
  /// One step: every substep of every system between the two halves of every coupling (core/coupling.h), with
  /// checks that positions and velocities are finite and, every so often, that everything is and that no
  /// energy came from nothing (Instability if not; the state is then unusable and the caller restores an
  /// older one). `profiles` has `profiled` entries, or is empty when nobody asked where the time goes.
  void step(WorldState& state, Workspace& workspace, const ThreadArena& arena,
            std::span<Profile> profiles) const;
  /// The look that `step` takes every so often, at the present state: Instability when something is wrong.
  void examine(WorldState& state, Workspace& workspace, const ThreadArena& arena) const;
  /// Carries out a command between two steps; Error "bad_command" or "unknown_system".
  void apply(WorldState& state, const Command& command) const;

  /// Sums ("energy.total"), every system's and coupling's own ("<id>.energy.total") and probes
  /// ("<probe>.position.x"). Scenes with "accuracy": "error.estimate", the relative error of its quantity.
  Observables observe(const WorldState& state) const;

  /// Names and units of everything that `observe` gives in this or any later state.
  std::vector<Observation> known_observables() const;

  /// The scene's estimate (scene/admission.h), with the steps of implicit methods by the matrices that this
  /// world's systems have.
  Cost cost(const WorldState& state) const;

  /// What systems say of the results of the last step (System::warn), `suggested_dt` that of the session
  /// step.
  struct SystemWarning {
    size_t system;
    Warning warning;
  };
  std::vector<SystemWarning> warnings(const WorldState& state) const;

  /// Systems, then couplings: what has a profile of its own.
  size_t profiled() const { return systems_.size() + couplings_.size(); }

  struct PlanEntry {
    std::string system;  ///< id of a system or coupling; empty: of neither
    PlanRow row;
    std::optional<size_t> profile;  ///< index among the `profiled`
  };
  /// Passes that a step runs, in order, and those it does not need, with the reasons.
  const std::vector<PlanEntry>& plan() const { return plan_; }
  /// Steps whose end is looked at as a whole: 1, 2, 4, 8, then every 16th. Energies cost about a third of a
  /// pass of forces.
  static bool watched(uint64_t step);
  /// Largest dt (s) of the session step that every method is known to hold in this state.
  std::optional<double> stable_dt(const WorldState& state) const;

 private:
  World() = default;
  void build(std::vector<Issue>& issues, std::span<const std::string> lost_ids);
  BuiltScene built() const { return {scene_, systems_, couplings_, {}}; }
  void build_system(size_t i, bool meets_bodies, std::vector<Issue>& issues);
  void build_couplings(std::vector<Issue>& issues);
  /// Builds systems again whose points touch bodies, by the methods that this is solved with, and divides
  /// steps that are too long for them where the scene does not say how.
  void let_bodies_be_met(std::vector<Issue>& issues);
  void build_finer();
  [[noreturn]] void reject(size_t i, const State& state, const State::BadValue& bad) const;
  void find_joined();
  void list_plan();
  /// Substeps of h (s), numbered from `first` on.
  struct Pace {
    double h;
    uint64_t first, count;
  };
  void substeps(WorldState& state, const Pace& pace, Workspace& workspace, const ThreadArena& arena,
                std::span<Profile> profiles) const;
  /// The same in parts where systems that are tied together would gain energy that nothing brings.
  void substeps_of_tied(WorldState& state, const Pace& pace, Workspace& workspace, const ThreadArena& arena,
                        std::span<Profile> profiles) const;
  /// Times what a step may add that tied systems have gained since `before`; 0: no more than that.
  double gained(const WorldState& state, std::span<const std::optional<Energy>> before, double t,
                Workspace& workspace, const ThreadArena& arena) const;
  void find_tied();
  /// At everything in all systems at the end of a step.
  void look(WorldState& state, uint64_t step, Workspace& workspace, const ThreadArena& arena) const;
  /// Throws Instability when the energy of system i is not finite or when it and what couplings join to it
  /// have more than they could; of systems that are joined the first watches for all.
  void watch_energy(WorldState& state, size_t i, double t, Workspace& workspace,
                    const ThreadArena& arena) const;
  /// Of all systems joined to system i and of what their couplings store; nothing when one of them knows
  /// none.
  std::optional<Energy> energy_together(const WorldState& state, size_t i, double t, Workspace& workspace,
                                        const ThreadArena& arena) const;
  std::optional<Energy> energy(const WorldState& state, size_t i) const;
  double error_estimate(const WorldState& state) const;
  CoupledStates sides(WorldState& state, size_t coupling) const;
  ConstCoupledStates sides(const WorldState& state, size_t coupling) const;
  void observe_probe(const ProbeParams& probe, const WorldState& state, Observables& out) const;

  Scene scene_;
  std::vector<std::unique_ptr<const System>> systems_;
  std::vector<std::unique_ptr<const Coupling>> couplings_;
  /// Scenes with "accuracy": the same scene computed more finely beside it, which is what "error.estimate" is
  /// made of (step doubling over the whole run: Hairer, Norsett, Wanner 1993, section II.4). Null otherwise.
  std::unique_ptr<const World> finer_;
  PartTable parts_;
  std::vector<size_t> joined_to_;     ///< per system, the first of those that couplings join it to
  std::vector<size_t> tied_;          ///< the firsts of systems with points that answer together
  std::vector<double> speed_limits_;  ///< per system, infinity where there is none
  std::vector<PlanEntry> plan_;
};

}  // namespace truestep
