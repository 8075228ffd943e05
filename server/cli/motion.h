// truestep motion: exports the motion of a skeleton or blended surface to a file for other programs.
#pragma once
#include <CLI/App.hpp>

namespace truestep {

/// Adds the subcommand; `exit_code` receives its result.
void add_motion_command(CLI::App& app, int& exit_code);

}  // namespace truestep
