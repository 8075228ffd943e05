// `truestep replay`: repeats a bundle and compares hashes.
#pragma once
namespace CLI {
class App;
}
namespace truestep {
void add_replay_command(CLI::App& app, int& exit_code);
}  // namespace truestep
