// The command `systems`: every kind of system, coupling and command, and the scene's own members, with
// parameters, outputs, guarantees and a smallest scene.
#pragma once
#include "server/cli/arguments.h"

namespace truestep {

void add_systems_command(Arguments app, int& exit_code);

}  // namespace truestep
