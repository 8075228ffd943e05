// truestep info | export | diff: inspect, convert and compare recordings.
#pragma once
#include <CLI/App.hpp>

namespace truestep {

void add_recording_commands(CLI::App& app, int& exit_code);

}  // namespace truestep
