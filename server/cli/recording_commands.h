// truestep info | export | diff: inspect, convert and compare recordings.
#pragma once
#include "server/cli/arguments.h"

namespace truestep {

void add_recording_commands(Arguments app, int& exit_code);

}  // namespace truestep
