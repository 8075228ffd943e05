// `truestep study`: runs a study of a scene and writes its table, plot and result.
#pragma once
namespace CLI {
class App;
}
namespace truestep {
void add_study_command(CLI::App& app, int& exit_code);
}  // namespace truestep
