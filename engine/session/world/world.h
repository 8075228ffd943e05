// A world: the systems of a scene, their couplings, their clock and the plan of a step. Immutable; the state
// is kept outside. Time is step * dt, and substep k of step n starts at (n * substeps + k) * h.
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/coupling.h"
#include "engine/core/system.h"
#include "engine/scene/scene.h"
#include "engine/session/snapshot/references.h"
#include "engine/session/world/part_table.h"

namespace truestep {

/// Largest step number that JSON numbers represent exactly.
inline constexpr uint64_t kMostStep = 9'000'000'000'000'000;

/// The states of all systems and couplings at the end of step `step`.
struct WorldState {
  uint64_t step = 0;
  std::vector<State> systems;
  std::vector<State> couplings;
  std::vector<WorldState> finer;   ///< the companion used to estimate errors: one, or none
  std::vector<EnergyWatch> watch;  ///< per system, from its first step on

  /// Hash of everything but the watch, which says when a run ends or a step is divided.
  uint64_t hash() const;
  friend bool operator==(const WorldState&, const WorldState&) = default;
  /// Little-endian bytes, read by deserialize (Error "bad_snapshot").
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
  /// /couplings/<i> if any refuses.
  explicit World(Scene scene);
  /// Faults of a report's draft beyond those found by reading: its sound parts are built to find them.
  static std::vector<Issue> more_faults(const SceneReport& report);

  const Scene& scene() const { return scene_; }
  double dt() const { return scene_.header.time.dt; }
  size_t size() const { return systems_.size(); }
  const System& system(size_t i) const { return *systems_[i]; }
  const std::string& id(size_t i) const { return scene_.systems[i].id; }
  /// What can be streamed, recorded, drawn and probed: the parts of all systems, in order.
  const PartTable& parts() const { return parts_; }
  FieldView field(const WorldState& state, const FieldPlace& at, std::vector<double>& scratch) const {
    return parts_[at.part].field(state.systems[parts_[at.part].system], at.field, scratch);
  }
  /// Draws what is requested of all systems; with Wish::constant, one PartDrawing per part of the world.
  void draw(const WorldState& state, Wish wishes, Drawing& out) const;
  uint32_t drawing_version(const WorldState& state) const;
  const std::vector<std::unique_ptr<const Coupling>>& couplings() const { return couplings_; }
  /// Index of the system with this id; Error "unknown_system" listing the existing ones.
  size_t index_of(std::string_view id) const;

  /// Error "scene_invalid" when one of its numbers does not fit its type.
  WorldState initial_state() const;
  /// Error "bad_snapshot" unless a state from outside can be stepped: it needs the columns of this world's
  /// states, matching rows and finite numbers.
  void require_state(const WorldState& state) const;
  /// Hash of everything in the scene that affects motion: two scenes with the same fingerprint continue a
  /// state identically.
  uint64_t fingerprint() const;
  /// Error "scene_invalid" when an initial state has more energy than a number can hold.
  void require_finite_energy(const WorldState& state) const;
  /// One step: every substep of every system between the two halves of every coupling (core/coupling.h), with
  /// checks that positions and velocities are finite and, at intervals, that everything is finite and that no
  /// energy has come from nothing (Instability if not; the state is then unusable and the caller restores an
  /// older one). `profiles` has `profiled` entries, or is empty when nobody is profiling.
  void step(WorldState& state, Workspace& workspace, const ThreadArena& arena,
            std::span<Profile> profiles) const;
  /// The check that `step` makes at intervals, on the present state: Instability when something is wrong.
  void examine(WorldState& state, Workspace& workspace, const ThreadArena& arena) const;
  /// Carries out a command between two steps; Error "bad_command" or "unknown_system".
  void apply(WorldState& state, const Command& command) const;

  /// Sums ("energy.total"), the observables of every system and coupling ("<id>.energy.total") and probes
  /// ("<probe>.position.x"). Scenes with "accuracy": "error.estimate", the relative error of its quantity.
  /// What is costly and not wanted is left out; without `wanted`, nothing.
  Observables observe(const WorldState& state, const WantedObservables& wanted = {}) const;

  /// Names and units of everything that `observe` returns in this or any later state.
  std::vector<Observation> known_observables() const;

  /// The scene's estimate (scene/admission.h), with the cost of implicit methods taken from the matrices of
  /// this world's systems.
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
    std::string system;  ///< id of a system or coupling; empty: neither
    PlanRow row;
    std::optional<size_t> profile;  ///< index among the `profiled`
  };
  /// Passes that a step runs, in order, and those it does not need, each with its reason.
  const std::vector<PlanEntry>& plan() const { return plan_; }
  /// Steps after which everything is checked: 1, 2, 4, 8, then every 16th. Energies cost about a third of a
  /// force pass.
  static bool watched(uint64_t step);
  /// Largest session step dt (s) that every method is known to tolerate in this state.
  std::optional<double> stable_dt(const WorldState& state) const;
  /// Substeps of a step that points need which bodies press on or hang on, where they are put by constraints
  /// (PressedPoints): the default, unless the scene chooses a number.
  double substeps_of_pressed() const;

 private:
  World() = default;
  void build(std::vector<Issue>& issues, std::span<const std::string> lost_ids);
  BuiltScene built() const { return {scene_, systems_, couplings_, {}}; }
  void build_system(size_t i, bool meets_bodies, std::vector<Issue>& issues);
  void build_couplings(std::vector<Issue>& issues);
  /// Rebuilds systems whose points touch bodies with methods that can be solved together with them. Returns
  /// which.
  std::vector<bool> let_bodies_be_met(std::vector<Issue>& issues);
  /// Builds the couplings. Where steps are too long for them, or for points that meet bodies, they are
  /// divided and everything is built again; a number of substeps that the scene chose is refused instead.
  void couple(const std::vector<bool>& meets, std::vector<Issue>& issues);
  /// Substeps that points held against bodies need.
  double substeps_of_points(const std::vector<bool>& meets) const;
  /// Substeps that couplings need, and the id of the one that needs most.
  std::pair<double, std::string> substeps_of_couplings() const;
  Issue too_few_substeps(double needed, const std::string& coupling) const;
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
  /// The same, subdivided where systems tied together would gain energy from nothing.
  void substeps_of_tied(WorldState& state, const Pace& pace, Workspace& workspace, const ThreadArena& arena,
                        std::span<Profile> profiles) const;
  /// Energy gained by tied systems in a step.
  struct Gain {
    double times = 0;  ///< what a step may add; 0: no more than that
    enum class Total : uint8_t { within, above_start } total = Total::within;  ///< of all systems that gained
  };
  Gain gained(const WorldState& state, std::span<const std::optional<Energy>> before, double t,
              Workspace& workspace, const ThreadArena& arena) const;
  void find_tied();
  /// Watches the energy of tied systems after every step: what comes from nothing soon is many times that.
  void watch_tied(WorldState& state, Workspace& workspace, const ThreadArena& arena) const;
  /// Checks everything in all systems at the end of a step.
  void look(WorldState& state, uint64_t step, Workspace& workspace, const ThreadArena& arena) const;
  /// Throws Instability when the energy of system i is not finite, or when it and the systems joined to it by
  /// couplings have more than they could; among joined systems the first one watches for all.
  void watch_energy(WorldState& state, size_t i, double t, Workspace& workspace,
                    const ThreadArena& arena) const;
  /// Energy of all systems joined to system i and of their couplings; empty when one of them does not know
  /// its own.
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
  /// Scenes with "accuracy": the same scene computed more finely in parallel, from which "error.estimate" is
  /// made of (step doubling over the whole run: Hairer, Norsett, Wanner 1993, section II.4). Null otherwise.
  std::unique_ptr<const World> finer_;
  PartTable parts_;
  std::vector<size_t> joined_to_;  ///< per system, the first of the systems joined to it by couplings
  /// Systems that couplings join and that know their energies.
  struct Tied {
    size_t first;  ///< of the group
    /// Whether the points of one of them do not move by the sum of the forces on each: they are solved
    /// together, or put where constraints hold. Otherwise energy may swing within a method's own accuracy.
    enum class Points : uint8_t { by_forces, solved } points;
    double start = 0;  ///< J, of all of them at t = 0
  };
  std::vector<Tied> tied_;
  uint64_t most_parts_ = 256;         ///< that a step of theirs is divided into
  std::vector<double> speed_limits_;  ///< per system, infinity if there is none
  std::vector<PlanEntry> plan_;
};

}  // namespace truestep
