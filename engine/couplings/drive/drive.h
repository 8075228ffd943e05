// The coupling type "drive": a control of an animation sets a parameter of another system before every
// substep, as the command set_parameter would: curves and expressions of time for stiffness, wind, damping,
// loads. The value is the control's at the substep's start.
#pragma once
#include <memory>
#include <string>

#include "engine/core/build.h"
#include "engine/core/coupling.h"
#include "engine/core/def.h"

namespace truestep::drive {

struct DriveDef {
  std::string control, parameter;
};

const DefTable& drive_table();
Cost drive_cost(const void* def, const Cost& a, const Cost& b);
/// Side a has the control, b the parameter; Error "scene_invalid" when either name does not exist or b
/// refuses the value at t = 0.
std::unique_ptr<const Coupling> build_drive(const void* def, const CouplingContext& context);

}  // namespace truestep::drive
