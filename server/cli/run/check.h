// truestep check: scenes with their tests, all of a folder in one process.
#pragma once
namespace CLI {
class App;
}
namespace truestep {
void add_check_command(CLI::App& app, int& exit_code);
}  // namespace truestep
