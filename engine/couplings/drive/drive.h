// The coupling type "drive": what an animation tells another system. Before every substep
//   a control sets a number, a path a vector, a vector a list of numbers and vectors, as set_parameter would:
//     curves and expressions of time for stiffnesses, wind, loads, motors; the value at the substep's start;
//   a path and a turn move a body of b: it keeps the place that it has in their frame at t = 0, and moves on
//     with the velocities that take it to where it is a substep later.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/build.h"
#include "engine/core/coupling.h"
#include "engine/core/def.h"

namespace truestep::drive {

struct DriveDef {
  std::string control, path, vector, turn;
  std::string parameter;
  std::vector<std::string> parameters;
  std::optional<int64_t> index, body;
};

const DefTable& drive_table();
Cost drive_cost(const void* def, const Cost& a, const Cost& b);
/// Side a has the channels, b the parameters or the body; Error "scene_invalid" where either has none of that
/// name, where numbers and vectors do not fit, or where b refuses a value at t = 0.
std::unique_ptr<const Coupling> build_drive(const void* def, const CouplingContext& context);

/// A path and a turn that move a body.
std::unique_ptr<const Coupling> build_body_drive(const DriveDef& def, const CouplingContext& context);
[[noreturn]] void refuse_drive(const std::string& member, const std::string& why, const std::string& value,
                               const std::string& allowed);

}  // namespace truestep::drive
