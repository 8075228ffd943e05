// The coupling type "drive": an animation that drives another system. Before every substep
//   a control sets a number, a path a vector, and a vector a list of numbers and vectors, as set_parameter
//     would (curves and expressions of time for stiffnesses, wind, loads, motors), with the value at the
//     substep's start;
//   a path and a turn move a body of b: it keeps the pose that it has in their frame at t = 0 and has the
//     velocities that take it through the substep.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/coupling.h"
#include "engine/core/def/build.h"
#include "engine/core/def/def.h"

namespace truestep::drive {

struct DriveDef {
  std::string control, path, vector, turn;
  std::string parameter;
  std::vector<std::string> parameters;
  std::optional<int64_t> index, body;
};

const DefTable& drive_table();
Cost drive_cost(const void* def, const Cost& a, const Cost& b);
/// Side a has the channels, b the parameters or the body. Error "scene_invalid" if either has none of that
/// name, if numbers and vectors do not match, or if b rejects a value at t = 0.
std::unique_ptr<const Coupling> build_drive(const void* def, const CouplingContext& context);

/// A body moved by a path and a turn.
std::unique_ptr<const Coupling> build_body_drive(const DriveDef& def, const CouplingContext& context);
[[noreturn]] void refuse_drive(const std::string& member, const std::string& why, const std::string& value,
                               const std::string& allowed);

}  // namespace truestep::drive
