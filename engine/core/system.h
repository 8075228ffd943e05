// A physical system: immutable once built. Every member is const and all change happens in the State passed
// in, so one system can advance two states alternately without interference.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/base/profile.h"
#include "engine/core/commands/command.h"
#include "engine/core/drawing.h"
#include "engine/core/energy.h"
#include "engine/core/observables.h"
#include "engine/core/part.h"
#include "engine/core/ports/ports.h"
#include "engine/core/state/state.h"
#include "engine/core/state/state_check.h"
#include "engine/core/state/workspace.h"
#include "engine/core/warning.h"

namespace truestep {

class ForceField;          // core/equations/force_field.h
struct Integrator;         // core/equations/integrator.h
struct IntegratorOptions;  // the same
struct ImmersedBody;       // core/ports/medium.h

/// How a system is integrated in time, as far as the table of methods knows; see System::integration.
struct Integration {
  const Integrator* method = nullptr;          ///< null: the system has a step of its own
  const IntegratorOptions* options = nullptr;  ///< set when there is a method
  const ForceField* field = nullptr;           ///< what it advances, if that is made of forces
};

/// What a step is given. Time is step * h exactly, never an accumulated sum.
struct StepInput {
  double t = 0;       ///< s, at the step's start
  double h = 0;       ///< s, length of this (sub)step
  uint64_t step = 0;  ///< number of this (sub)step since the beginning, from 0
  Workspace& workspace;
  const ThreadArena& arena;
  Profile* profile = nullptr;           ///< null: no profiling
  std::span<ImmersedBody> bodies = {};  ///< those in a medium (Ports::medium), which it moves and pushes
};

/// A pass of a step, or one that this scene does not need, with the reason in either case.
struct PlanRow {
  enum class Status : uint8_t { runs, skipped } status = Status::runs;
  std::string name;
  std::string reason;
};

/// What may be known about the limits of a system's method; `System::limit` gives the value.
enum class Limit : uint8_t {
  stable_dt,    ///< s, largest step that the method is known to tolerate in this state
  speed,        ///< velocity, in its own unit, that nothing in the system's energy explains, in any of its
                ///< states: a step that leaves one beyond it has failed
  step_seconds  ///< s on one core that a step of h from this state takes, where building the system tells
                ///< more than its parameters do (the pattern of an implicit method's matrix)
};

class System {
 public:
  System();
  System(const System&) = delete;
  System& operator=(const System&) = delete;
  virtual ~System();

  virtual State initial_state() const = 0;
  /// Advances the state by input.h. Throws Instability when it cannot.
  virtual void step(State& state, const StepInput& input) const = 0;
  /// Adds energies, momenta, residuals of this state (t in s). Values not yet defined are NaN, so that the
  /// names are the same throughout a run. What takes a pass of its own is left out unless it is wanted.
  virtual void observe(const State& state, double t, Observables& out) const = 0;
  /// Carries out a command between two steps. Error "bad_command" (with an Issue) when it makes no sense.
  virtual void apply(State& state, const Command& command) const = 0;
  /// Passes of this system's step in order, then what this scene does not need.
  virtual std::vector<PlanRow> plan() const = 0;

  /// What can be streamed, recorded, drawn and probed; the main part first.
  const std::vector<PartInfo>& parts() const { return parts_; }
  /// The first field with this name, main part first.
  std::optional<FieldPlace> find_field(std::string_view name) const;
  /// Values of a field of a part; fields that nobody asks for are not computed.
  virtual FieldView field(const State& state, size_t part, size_t field,
                          std::vector<double>& scratch) const = 0;
  /// Adds what was requested to an empty drawing, at time t (s), and the version of its constant part where
  /// that can change. What was not requested costs nothing.
  virtual void draw(const State& state, double t, Wish wishes, Drawing& out) const {}

  /// The row of the table that advances this system, and the field it advances. Valid while the system lives.
  const Integration& integration() const { return integration_; }
  /// Remedies when a step fails, one sentence each, in this system's own terms; empty: a shorter step,
  /// another method or softer forces.
  const std::vector<std::string>& remedies() const { return remedies_; }
  /// Where couplings reach into this system's states. Valid while the system lives.
  virtual Ports ports() const { return {}; }
  /// Empty when unknown or there is none. `h` (s) is used only for `step_seconds`.
  virtual std::optional<double> limit(Limit which, const State& state, double h) const {
    return std::nullopt;
  }
  /// Adds reasons not to trust the result of the last step; `h` (s) is the length of that step. Called every
  /// few steps: it reads values that the step has stored, not rows.
  virtual void warn(const State& state, double h, std::vector<Warning>& out) const {}
  /// Energies of this state at time t (s); empty if the system has none. Called every few steps, and
  /// allocates nothing after the first call.
  virtual std::optional<Energy> energy(const State& state, double t, Workspace& workspace,
                                       const ThreadArena& arena) const {
    return std::nullopt;
  }
  /// Names the columns that grow or hold row indices, with their bounds, for a state from outside at time t
  /// (s): whatever passes can be stepped, observed and drawn.
  virtual void check(StateCheck& check, double t) const {}

 protected:
  /// By constructors.
  void set_parts(std::vector<PartInfo> parts);
  void set_remedies(std::vector<std::string> remedies);
  void set_integration(const Integration& integration) { integration_ = integration; }
  /// The main part, for constructors that know more about it than their bases.
  PartInfo& main_part() { return parts_.at(0); }

 private:
  std::vector<PartInfo> parts_;
  std::vector<std::string> remedies_;
  Integration integration_;
};

/// One named pass of a step.
struct Stage {
  std::string name;
  std::string reason;  ///< why this scene needs it
  std::function<void(State&, const StepInput&)> run;
};

/// A system whose step is a list of stages, fixed when it is built from what the scene needs.
class StagedSystem : public System {
 public:
  StagedSystem();
  ~StagedSystem() override;
  void step(State& state, const StepInput& input) const override;
  std::vector<PlanRow> plan() const override;

 protected:
  void add_stage(std::string name, std::string reason, std::function<void(State&, const StepInput&)> run);
  void skip_stage(std::string name, std::string reason);

 private:
  std::vector<Stage> stages_;
  std::vector<PlanRow> skipped_;
};

}  // namespace truestep

// Every system makes these; their members are compiled once, in system.cc.
extern template class std::vector<truestep::PlanRow>;
extern template class std::vector<truestep::Stage>;
