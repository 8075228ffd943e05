// `truestep study`: runs a study of a scene and writes its table, plot and result.
#pragma once
#include "server/cli/arguments.h"

namespace truestep {
void add_study_command(Arguments app, int& exit_code);
}  // namespace truestep
