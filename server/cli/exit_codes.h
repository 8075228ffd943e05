// Exit codes of the command line; scripts rely on them.
#pragma once
namespace truestep {
enum ExitCode : int {
  kExitOk = 0,
  kExitUsage = 2,
  kExitInvalidScene = 3,
  kExitUnstable = 4,
  kExitServer = 5,
  kExitMissed = 6,
  kExitInterrupted = 130,  ///< as shells report SIGINT
};
}  // namespace truestep
