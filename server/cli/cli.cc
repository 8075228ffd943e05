#include "server/cli/cli.h"

#include <iostream>

#include "engine/base/version.h"
#include "server/cli/exit_codes.h"

namespace truestep {

int run_command_line(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == "--version") {
    std::cout << version() << '\n';
    return kExitOk;
  }
  std::cerr << "usage: truestep --version\n";
  return kExitUsage;
}

}  // namespace truestep
