// How a system that is solved implicitly answers to impulses in a step of h, to first order:
//   A dv = J,  dx = h dv,  A = M - h df/dv - h^2 df/dx
// with the definite Jacobian at the step's end: the change of implicit Euler's solution when the forces give
// J more. What is put in place by such impulses shares its motion with all that stiff springs tie to it, so
// that it stretches none of them by more than the impulses' own work pays for; put in place by its own mass,
// a point on a spring of h^2 k = 100 m stores a hundred times the kinetic energy that the impulse gave.
#pragma once
#include "engine/core/force_field.h"
#include "engine/core/impulse_answer.h"
#include "engine/core/integrator.h"

namespace truestep {

/// For fields with a symmetric Jacobian and dx/dt = v. Directions that RowContacts hold do not answer, nor do
/// held rows. Arguments as for AnswersImpulses::answer.
void answer_implicitly(const ForceField& field, const IntegratorOptions& options, State& state,
                       const StepInput& in, AnswersImpulses::Answer which, std::span<const double> impulses,
                       std::span<double> dv);

}  // namespace truestep
