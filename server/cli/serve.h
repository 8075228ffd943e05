// truestep serve and truestep health.
#pragma once
#include "server/cli/arguments.h"

namespace truestep {

void add_serve_command(Arguments app, int& exit_code);

}  // namespace truestep
