// truestep run: a scene from file or gallery, without a server.
#pragma once
#include <CLI/App.hpp>

namespace truestep {

/// Adds the subcommand; `exit_code` receives its result.
void add_run_command(CLI::App& app, int& exit_code);

}  // namespace truestep
