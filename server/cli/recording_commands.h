// truestep info | export | diff: what recordings hold.
#pragma once
#include <CLI/App.hpp>

namespace truestep {

void add_recording_commands(CLI::App& app, int& exit_code);

}  // namespace truestep
