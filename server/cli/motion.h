// truestep motion: exports the motion of a skeleton or blended surface to a file for other programs.
#pragma once
#include "server/cli/arguments.h"

namespace truestep {

/// Adds the subcommand; `exit_code` receives its result.
void add_motion_command(Arguments app, int& exit_code);

}  // namespace truestep
