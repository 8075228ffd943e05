// Ctrl-C (SIGINT) and SIGTERM for commands that write files: they finish in an orderly way. A second signal
// ends the process at once.
#pragma once
namespace truestep {

/// From now on the signals are recorded instead of ending the process.
void note_interruptions();
/// Whether a signal has arrived.
bool interrupted();

}  // namespace truestep
