// A physical system: immutable once built. Every member is const and all change happens in the State it is
// handed, so two states advanced alternately by one system do not notice each other.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/base/profile.h"
#include "engine/core/command.h"
#include "engine/core/drawn.h"
#include "engine/core/energy.h"
#include "engine/core/observables.h"
#include "engine/core/points.h"
#include "engine/core/state.h"
#include "engine/core/state_check.h"
#include "engine/core/topology.h"
#include "engine/core/workspace.h"

namespace truestep {

/// What a step is given. Time is step * h exactly, never an accumulated sum.
struct StepInput {
  double t = 0;       ///< s, at the step's start
  double h = 0;       ///< s, length of this (sub)step
  uint64_t step = 0;  ///< number of this (sub)step since the beginning, from 0
  Workspace& workspace;
  const ThreadArena& arena;
  Profile* profile = nullptr;  ///< null: nobody asked where the time goes
};

/// A pass of a step, or one that this scene does not need, with the reason either way.
struct PlanRow {
  enum class Status : uint8_t { runs, skipped } status = Status::runs;
  std::string name;
  std::string reason;
};

/// Something that may be streamed, recorded or drawn.
struct FieldInfo {
  std::string name;
  std::string unit;
  Scalar type = Scalar::f64;
  uint32_t width = 1;
};

/// rows x width elements of a field, either inside the state or inside the scratch that was handed over.
struct FieldView {
  const void* data = nullptr;
  Scalar type = Scalar::f64;
  size_t rows = 0;
  uint32_t width = 1;
};

class System {
 public:
  virtual ~System() = default;

  virtual State initial_state() const = 0;
  /// Advances the state by input.h. Throws Instability when it cannot.
  virtual void step(State& state, const StepInput& input) const = 0;
  /// Adds energies, momenta, residuals of this state (t in s).
  virtual void observe(const State& state, double t, Observables& out) const = 0;
  /// Adds what `observe` gives out only later in a run, with any value: a time that has not come yet.
  virtual void late_observables(Observables& out) const {}

  /// Fields that exist, "position" first where there is one. The order is that of `field`'s index.
  virtual std::vector<FieldInfo> fields() const = 0;
  /// The field's values; nothing is computed for fields nobody asks for.
  virtual FieldView field(const State& state, size_t which, std::vector<double>& scratch) const = 0;

  /// Names the columns that grow or point to rows, with what they may hold, for a state at time t (s) that
  /// came from outside: whatever passes can be stepped, observed and drawn.
  virtual void check(StateCheck& check, double t) const {}

  /// Carries out a command between two steps. Error "bad_command" (with an Issue) when it makes no sense.
  virtual void apply(State& state, const Command& command) const = 0;

  /// Passes of this system's step in order, then what this scene does not need.
  virtual std::vector<PlanRow> plan() const = 0;

  virtual Topology topology(const State& state) const { return {}; }
  /// Solids that rows of "position" and "orientation" carry. A row is dimmed where the field "asleep" is not
  /// 0.
  virtual DrawnBodies bodies(const State& state) const { return {}; }
  /// Changes when `topology` or `bodies` does.
  virtual uint32_t topology_version(const State& state) const { return 1; }
  /// Obstacles at time t (s), for drawing.
  virtual std::vector<DrawnShape> shapes(const State& state, double t) const { return {}; }
  /// Where bodies touch, for pictures that were asked to show it.
  virtual std::vector<ContactMark> contact_marks(const State& state) const { return {}; }
  /// Joints that hold, for pictures that were asked to show them.
  virtual std::vector<JointMark> joint_marks(const State& state) const { return {}; }
  /// Largest dt (s) that this system's method is known to hold in this state; nothing when unknown or
  /// unlimited.
  virtual std::optional<double> stable_dt(const State& state) const { return std::nullopt; }
  /// Seconds on one core that a step of h (s) from this state is expected to take, where building the system
  /// tells more than its parameters do (the pattern of an implicit method's matrix).
  virtual std::optional<double> step_seconds(const State& state, double h) const { return std::nullopt; }
  /// What helps when a step fails, one sentence each, in this system's own words; empty: a shorter step,
  /// another method or softer forces.
  virtual std::vector<std::string> remedies() const { return {}; }
  /// Where couplings find the points of this system's states; nothing when it has none that they could move.
  virtual std::optional<PointColumns> points() const { return std::nullopt; }
  /// Solids that points of other systems collide with; corners are rows of `points`. Valid while the system
  /// lives.
  virtual PublishedSolids solids() const { return {}; }
  /// Velocity (in its own unit) that nothing in this system's energy explains; a step that leaves one beyond
  /// it has failed. Nothing where the energy has no bound (emitters, expressions).
  virtual std::optional<double> speed_limit() const { return std::nullopt; }
  /// Energies of this state at time t (s); nothing when the system knows none. Asked for every few steps, and
  /// allocates nothing after the first time.
  virtual std::optional<Energy> energy(const State& state, double t, Workspace& workspace,
                                       const ThreadArena& arena) const {
    return std::nullopt;
  }
  /// Upper bound of rows that "position" may reach (emitters grow).
  virtual size_t max_rows() const = 0;
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
