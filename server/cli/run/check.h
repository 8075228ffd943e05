// truestep check: scenes with their tests, all of a folder in one process.
#pragma once
#include "server/cli/arguments.h"

namespace truestep {
void add_check_command(Arguments app, int& exit_code);
}  // namespace truestep
