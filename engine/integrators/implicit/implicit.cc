// Implicit Euler and its one-step linearisation:
//   implicit_euler         x' = x + h G(x') v',  v' = v + h a(x', v', t + h)
//   linear_implicit_euler  (M - h df/dv - h^2 df/dx) dv = h (f + h df/dx v),  v' = v + dv,  x' = x + h v'
// which is one Newton step of the former from x' = x; with v' = dx / h and no damping it reads
//   (M/h^2 - df/dx) dx = M v / h + f.
// Baraff, Witkin 1998, "Large steps in cloth simulation", eq. 6. Fields without a Jacobian use differences:
// small ones central differences and a matrix of (x, v), larger ones as first-order equations (sdirk.cc), as
// do those with a linear solver of their own. Steps of implicit_euler that ended with damping and air lagged
// at the step's start are counted in the state and observed as integrator.held_steps.
#include "engine/integrators/implicit/implicit.h"

#include "engine/core/equations/lagged_dissipation.h"
#include "engine/core/equations/linear_solver.h"
#include "engine/integrators/field_equations.h"
#include "engine/integrators/implicit/implicit_methods.h"
#include "engine/integrators/table/methods.h"

namespace truestep {

namespace {

bool sparse(Motion& m) {
  return m.field.has_jacobian() && m.plain_rate();
}

void step(const ForceField& field, State& state, const StepInput& in, const IntegratorOptions& options,
          NewtonSteps steps) {
  Motion m(field, state, in);
  if (!sparse(m) && (m.x.size() + m.v.size() > kDenseUnknowns || FieldEquations(m).linear_solver())) {
    AdvanceFunction* whole =
        steps == NewtonSteps::one ? advance_linear_implicit_euler : advance_implicit_euler;
    return step_equations(whole, field, state, in, options, MethodHistory::kept);
  }
  if (sparse(m)) {
    steps == NewtonSteps::one ? linear_implicit_euler_sparse(m, options) : implicit_euler_sparse(m, options);
  } else {
    implicit_euler_dense(m, options, steps);
  }
  m.project();
}

}  // namespace

std::optional<std::string> refuses_without_jacobian(const ForceField& field) {
  if (field.linear_solver()) return std::nullopt;
  State state = field.initial_state();
  Workspace workspace;
  const ThreadArena serial(1);
  const StepInput in{.workspace = workspace, .arena = serial};
  Motion m(field, state, in);
  // If dx/dt = v only half of them are solved for.
  const size_t unknowns = m.plain_rate() ? m.v.size() : m.x.size() + m.v.size();
  if (sparse(m) || unknowns <= kMostDifferences) return std::nullopt;
  return "implicit methods need the forces' derivatives, which this system does not provide, and " +
         std::to_string(unknowns) + " unknowns are too many for differences (at most " +
         std::to_string(kMostDifferences) + ")";
}

void prepare_implicit_euler(const ForceField& field, State& state) {
  const bool may_hold = field.lagged_dissipation() && field.dependence() == Dependence::position_and_velocity;
  if (may_hold) state.add({std::string(kHeldSteps), "1", Scalar::u64}, 1);
}

void observe_implicit_euler(const State& state, Observables& out) {
  if (const auto c = state.find(kHeldSteps)) {
    out.add(kHeldSteps, static_cast<double>(state.span<uint64_t>(*c)[0]), "1");
  }
}

void step_implicit_euler(const ForceField& field, State& state, const StepInput& in,
                         const IntegratorOptions& options) {
  step(field, state, in, options, NewtonSteps::converged);
}

void step_linear_implicit_euler(const ForceField& field, State& state, const StepInput& in,
                                const IntegratorOptions& options) {
  step(field, state, in, options, NewtonSteps::one);
}

}  // namespace truestep
