// truestep run: a scene from file or gallery, without a server.
#pragma once
#include "server/cli/arguments.h"

namespace truestep {

/// Adds the subcommand; `exit_code` receives its result.
void add_run_command(Arguments app, int& exit_code);

}  // namespace truestep
