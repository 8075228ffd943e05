#include "server/cli/cli.h"

#include <algorithm>
#include <iostream>

#include "engine/base/errors.h"
#include "engine/base/version.h"
#include "server/cli/arguments.h"
#include "server/cli/completion.h"
#include "server/cli/describe/describe_commands.h"
#include "server/cli/exit_codes.h"
#include "server/cli/input.h"
#include "server/cli/motion.h"
#include "server/cli/pictures/render.h"
#include "server/cli/recording_commands.h"
#include "server/cli/run/check.h"
#include "server/cli/run/replay.h"
#include "server/cli/run/run.h"
#include "server/cli/serve.h"
#include "server/cli/study.h"

namespace truestep {

namespace {

int exit_code_of(const Error& e) {
  const std::string& c = e.code();
  if (c == "scene_invalid" || c == "bad_json" || c == "too_large" || c == "accuracy_unreachable" ||
      c == "bad_snapshot" || c == "bad_bundle" || c == "bad_command" || c == "recording_foreign" ||
      c == "recording_damaged")
    return kExitInvalidScene;
  if (c == "interrupted") return kExitInterrupted;
  if (c == "instability") return kExitUnstable;
  if (c == "not_found" || c == "bad_request" || c == "unknown_format" || c == "unknown_system" ||
      c == "unsuitable_system")
    return kExitUsage;
  return kExitServer;
}

bool is_command(const Arguments& app, const std::string& word) {
  const auto all = app.subcommands();
  return std::any_of(all.begin(), all.end(), [&](const Arguments::Known& c) { return c.name == word; });
}

// Refuses a first word that is not a command and suggests the nearest one; the parser would only say that a
// command is missing.
int refuse_command(const Arguments& app, const std::string& word) {
  std::vector<std::string> names;
  for (const Arguments::Known& c : app.subcommands()) names.push_back(c.name);
  std::cerr << "error: there is no command " << word << did_you_mean(word, names) << "\ncommands:";
  for (const std::string& name : names) std::cerr << ' ' << name;
  std::cerr << '\n';
  return kExitUsage;
}

constexpr const char* kExamples =
    "\nExamples:\n"
    "  truestep run figure_eight --picture eight.png   simulate a scene of the gallery, draw its end\n"
    "  truestep validate scene.json                               what is wrong with a scene, and what it "
    "costs\n"
    "  truestep serve                                             API and viewer on http://127.0.0.1:8080\n"
    "\ntruestep gallery lists the scenes that come with the program, truestep COMMAND --help the options.\n";

}  // namespace

int run_command_line(int argc, char** argv) {
  CommandLine line("Truestep: a physics simulation service", "truestep", std::string(version()));
  const Arguments app = line.arguments();
  int exit_code = kExitOk;
  add_run_command(app, exit_code);
  add_check_command(app, exit_code);
  add_study_command(app, exit_code);
  add_serve_command(app, exit_code);
  add_describe_commands(app, exit_code);
  add_recording_commands(app, exit_code);
  add_replay_command(app, exit_code);
  add_render_command(app, exit_code);
  add_motion_command(app, exit_code);
  add_completion_command(app, exit_code);
  if (argc == 1) {
    std::cout << line.help() << kExamples;
    return kExitOk;
  }
  if (const std::string word = argc > 1 ? argv[1] : "-"; !word.starts_with('-') && !is_command(app, word))
    return refuse_command(app, word);
  try {
    if (!line.parse(argc, argv)) return kExitUsage;
  } catch (const Error& e) {
    print_error(e);
    return exit_code_of(e);
  } catch (const std::exception& e) {
    std::cerr << "error: " << e.what() << '\n';
    return kExitServer;
  }
  return exit_code;
}

}  // namespace truestep
