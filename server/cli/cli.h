// The command line: one function per subcommand, the same engine as the server's.
#pragma once
namespace truestep {
/// Parses argv and runs the subcommand; returns the process's exit code (exit_codes.h).
int run_command_line(int argc, char** argv);
}  // namespace truestep
