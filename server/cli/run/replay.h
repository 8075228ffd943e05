// `truestep replay`: repeats a bundle and compares hashes.
#pragma once
#include "server/cli/arguments.h"

namespace truestep {
void add_replay_command(Arguments app, int& exit_code);
}  // namespace truestep
