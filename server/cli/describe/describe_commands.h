// truestep validate | systems | gallery | schema: what the program knows, printed.
#pragma once
#include "server/cli/arguments.h"

namespace truestep {

void add_describe_commands(Arguments app, int& exit_code);

}  // namespace truestep
