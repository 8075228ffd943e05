// The program: everything it does is decided by its command line.
#include "server/cli/cli.h"

int main(int argc, char** argv) {
  return truestep::run_command_line(argc, argv);
}
