// truestep render: pictures or a film of a scene or a recording.
#pragma once
#include "server/cli/arguments.h"

namespace truestep {

/// Adds the subcommand; `exit_code` receives its result.
void add_render_command(Arguments app, int& exit_code);

}  // namespace truestep
