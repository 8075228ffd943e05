// truestep serve and truestep health.
#pragma once
#include <CLI/App.hpp>

namespace truestep {

void add_serve_command(CLI::App& app, int& exit_code);

}  // namespace truestep
