// Ctrl-C (SIGINT) and SIGTERM for commands that write files: they finish in an orderly way. A second signal
// ends the process at once.
#pragma once
#include <atomic>

namespace truestep {

/// From now on the signals are recorded instead of ending the process.
void note_interruptions();
/// Whether a signal has arrived.
bool interrupted();
/// The same for an InterruptScope: work within it stops in the middle of a step, or of the search for
/// remedies after one that failed.
const std::atomic<bool>* interruption_flag();

}  // namespace truestep
