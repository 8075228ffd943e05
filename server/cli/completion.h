// truestep completion: scripts that complete commands, options, choices and gallery names in a shell.
#pragma once
#include "server/cli/arguments.h"

namespace truestep {

/// Adds the subcommand. Call it last: it completes the commands already added.
void add_completion_command(Arguments app, int& exit_code);

}  // namespace truestep
