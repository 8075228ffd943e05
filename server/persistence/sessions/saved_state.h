// A state from which a session is restored: a snapshot, or a mark for the start of the scene, and the
// commands of a future from which the session had gone back. One sealed file
// (engine/session/snapshot/sealed.h):
//   snapshot (empty: the start) | u64 count | per command u64 step, u64 number, JSON | u64 newest number
#pragma once
#include <vector>

#include "engine/session/session.h"
#include "engine/session/snapshot/sealed.h"

namespace truestep {

inline constexpr SealKind kSavedState{"TSTPKEPT", 1, "session_damaged", "saved state"};

struct SavedState {
  Bytes snapshot;
  std::vector<JournalEntry> ahead;
  uint64_t last_sequence = 0;
};

Bytes write_saved_state(const SavedState& state);
/// Error "session_damaged".
SavedState read_saved_state(std::span<const std::byte> file);

/// A command as text in the log, and back. Error "session_damaged".
std::string command_text(const Command& command);
Command command_of(std::string_view text);

}  // namespace truestep
