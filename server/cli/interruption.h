// Ctrl-C (SIGINT) and SIGTERM of commands that write files: they end what they do in order. A second one ends
// the process at once.
#pragma once
namespace truestep {

/// From now on the signals are noted instead of ending the process.
void note_interruptions();
/// Whether one came.
bool interrupted();

}  // namespace truestep
