// truestep validate | systems | gallery | schema: what the program knows, printed.
#pragma once
#include <CLI/App.hpp>

namespace truestep {

void add_describe_commands(CLI::App& app, int& exit_code);

}  // namespace truestep
