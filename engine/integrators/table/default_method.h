// The method of a force system whose scene names none: it must hold at the scene's own step. What is asked is
// the fastest motion of the start, omega and damping rate, against the methods' stability intervals.
#pragma once
#include <string>
#include <string_view>

#include "engine/core/build.h"
#include "engine/integrators/table/integrators.h"

namespace truestep {

/// Names of what a system uses by itself.
struct DefaultMethods {
  std::string_view usual;               ///< of fixed step, while the scene's step is inside its interval
  std::string_view divides = "dop853";  ///< adaptive and explicit, where it is outside by little
  std::string_view stiff = "bdf2";      ///< implicit, where that would take too many internal steps
};

struct ChosenMethod {
  const Integrator& row;
  std::string why;  ///< for the plan
};

/// The method that the scene names, whatever it can hold, or the first of `defaults` that holds steps of `dt`
/// (s) from the field's initial state. Errors of choose_integrator.
ChosenMethod settle_method(const IntegratorChoice& choice, const DefaultMethods& defaults,
                           const ForceField& field, double dt);

}  // namespace truestep
