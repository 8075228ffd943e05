// The response of an implicitly solved system to impulses in a step of h, to first order:
//   A dv = J,  dx = h dv,  A = M - h df/dv - h^2 df/dx
// with the definite Jacobian at the step's end: the change of implicit Euler's solution when the forces
// supply J in addition. A point corrected by such impulses shares its motion with everything tied to it by
// stiff springs, so it stretches none of them by more than the work of the impulses; corrected by its own
// mass alone, a point on a spring with h^2 k = 100 m would store a hundred times the kinetic energy of the
// impulse.
#pragma once
#include "engine/core/equations/force_field.h"
#include "engine/core/equations/impulse_answer.h"
#include "engine/core/equations/integrator.h"

namespace truestep {

/// For fields with a symmetric Jacobian and dx/dt = v. Held rows and directions held by RowContacts do not
/// respond. Arguments as for AnswersImpulses::answer.
void answer_implicitly(const ForceField& field, const IntegratorOptions& options, State& state,
                       const StepInput& in, AnswersImpulses::Answer which, std::span<const double> impulses,
                       std::span<double> dv);

}  // namespace truestep
