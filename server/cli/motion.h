// truestep motion: what a skeleton or a blended surface of a scene does, as a file of other programs.
#pragma once
#include <CLI/App.hpp>

namespace truestep {

/// Adds the subcommand; `exit_code` receives its result.
void add_motion_command(CLI::App& app, int& exit_code);

}  // namespace truestep
