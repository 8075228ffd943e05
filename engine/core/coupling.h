// What two systems do to each other. Const like a system: a coupling reads both states at the boundaries of a
// substep and writes equal and opposite impulses (and position corrections that keep the centre of mass) to
// them; whatever it must remember for later steps lives in a State of its own.
//
//   for each coupling, in order: begin      kicks of the first half, and a look at where everything is
//   for each coupling, in order: immerse    bodies for a medium, which moves them with itself
//   for each system:             step
//   for each coupling, in order: midway     a look at where the systems alone have led
//   for each coupling, backwards: emerge, end       kicks of the second half, contacts, corrections
//   for each coupling, in turn:  guard      until none changes anything: what holds whatever the others did
//
// The order is a palindrome, so that couplings by forces compose to second order (Strang 1968).
#pragma once
#include "engine/core/ports/medium.h"
#include "engine/core/ports/ports.h"
#include "engine/core/system.h"

namespace truestep {

/// The states of a coupling and of its two sides; `a` and `b` may be the same one.
struct CoupledStates {
  State& own;
  State& a;
  State& b;
};
struct ConstCoupledStates {
  const State& own;
  const State& a;
  const State& b;
};

class Coupling {
 public:
  virtual ~Coupling() = default;

  /// Everything that influences a later step, and the sums that are observed.
  virtual State initial_state() const = 0;
  /// Before both sides advance by input.h.
  virtual void begin(const CoupledStates& s, const StepInput& input) const = 0;
  /// After all couplings have begun: appends the bodies immersed in b, a medium, for input.h.
  virtual void immerse(const ConstCoupledStates& s, const StepInput& input,
                       std::vector<ImmersedBody>& out) const {}
  /// Before `end`: receives from the medium its effect on the bodies.
  virtual void emerge(const CoupledStates& s, const StepInput& input,
                      std::span<const ImmersedBody> bodies) const {}
  /// After both sides have advanced by input.h and before any coupling has ended. Must not write to them.
  virtual void midway(const CoupledStates& s, const StepInput& input) const {}
  /// After both sides have advanced by input.h.
  virtual void end(const CoupledStates& s, const StepInput& input) const = 0;
  /// After all couplings have ended: restores what must never be violated, and returns whether it changed
  /// anything.
  virtual bool guard(const CoupledStates& s, const StepInput& input) const { return false; }
  /// Adds what was exchanged: impulses, energy lost, energy stored ("energy.potential", J).
  virtual void observe(const ConstCoupledStates& s, Observables& out) const = 0;
  /// Energy in J stored by the coupling in this state. Called every few steps; must not allocate.
  virtual double stored_energy(const ConstCoupledStates& s) const { return 0; }
  /// Appends what is drawn of it; ends in part 0 are rows of a's first part, in part 1 of b's. When rows
  /// change places, the drawing version of their system changes.
  virtual void draw(const ConstCoupledStates& s, std::vector<DrawnString>& out) const {}
  /// What the scene's author may not have meant, one sentence each, with what would change it.
  virtual std::vector<std::string> doubts() const { return {}; }
  /// Passes of `begin` and `end`, then what this scene does not need.
  virtual std::vector<PlanRow> plan() const = 0;
  /// Largest substep (s) that the coupling is known to tolerate; empty when unknown or unlimited. In the
  /// initial state it bounds the scene's substeps.
  virtual std::optional<double> stable_h(const ConstCoupledStates& s) const { return std::nullopt; }
  /// s on one core that a substep of h takes the coupling alone, from what its two systems turned out to be;
  /// empty: as estimated from its parameters.
  virtual std::optional<double> step_seconds(const ConstCoupledStates& s, double h) const {
    return std::nullopt;
  }
};

/// What a coupling's factory is given: its sides with their states at t = 0.
struct CouplingSide {
  std::string id;
  const System& system;
  State state;
};
struct CouplingContext {
  std::string id;  ///< of the coupling
  const CouplingSide& a;
  const CouplingSide& b;
};

}  // namespace truestep
