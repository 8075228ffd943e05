// The method of a force system whose scene names none: it must be stable at the scene's own step. The
// criterion is the fastest motion of the initial state, omega and damping rate, against the methods'
// stability intervals.
#pragma once
#include <string>
#include <string_view>

#include "engine/core/def/build.h"
#include "engine/integrators/table/integrators.h"

namespace truestep {

/// Names of the methods that a system uses by default.
struct DefaultMethods {
  std::string_view usual;               ///< fixed step, while the scene's step is within its stability
                                        ///< interval
  std::string_view divides = "dop853";  ///< adaptive and explicit, when it is slightly outside
  std::string_view stiff = "bdf2";      ///< implicit, when that would take too many internal steps
};

struct ChosenMethod {
  const Integrator& row;
  std::string why;  ///< for the plan
};

/// The method that the scene names, stable or not, or the first of `defaults` that is stable at steps of `dt`
/// (s) from the field's initial state. Errors of choose_integrator.
ChosenMethod settle_method(const IntegratorChoice& choice, const DefaultMethods& defaults,
                           const ForceField& field, double dt);

}  // namespace truestep
