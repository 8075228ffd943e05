// The choice of the integration method for a scene's equations.
#pragma once
#include <string>

#include "engine/core/equations/integrator.h"
#include "engine/systems/ode/ode_equations.h"

namespace truestep::ode {

struct OdeMethod {
  const Integrator* row;
  std::string why;  ///< one sentence for the plan
  /// Of adaptive methods, unless the scene says otherwise.
  double relative_tolerance = kOdeTolerance, absolute_tolerance = kOdeTolerance;
};

/// The method that the scene names, or the default; see ode.h. `dt`: a substep, s. Error "scene_invalid"
/// listing the suitable methods.
OdeMethod choose_ode_method(const OdeDef& def, const OdeModel& model, double dt);

}  // namespace truestep::ode
