// A session as its folder tells it: the state that it is restored from, and what happened since. The newest
// state that can be read is taken, or an older one where a recording wants steps from before it; the logs
// lead from any of them to where the session stood.
#pragma once
#include <optional>

#include "server/persistence/record_log.h"
#include "server/persistence/saved_state.h"
#include "server/persistence/session_folder.h"

namespace truestep {

/// What the logs behind a state come to.
struct LoggedCourse {
  std::vector<JournalEntry> journal;        ///< from the state on, those of a future gone back from included
  std::optional<JournalEntry> unconfirmed;  ///< the newest command when nothing tells that it was carried out
  uint64_t step = 0;                        ///< where the session stood when that was last told
  uint64_t furthest = 0;                    ///< where it had been told to stand before at most
  uint64_t last_sequence = 0;
};
/// `from` is the state's step. Error "session_damaged" when the records contradict each other.
LoggedCourse follow(const SavedState& state, uint64_t from, std::span<const LogRecord> records);

struct SavedSession {
  SessionAbout about;
  SessionFolder::Scene scene;
  Bytes snapshot;  ///< empty: the scene's start
  uint64_t from_step = 0;
  LoggedCourse course;
  uint64_t next_number = 1;  ///< of a log or a state that is written from now on
  /// False when part of what the session did is unreadable, so that it stands earlier than it did.
  bool complete = true;
};

/// `recorded` is the last step of a recording that goes on. Error "session_damaged" or "folder_io".
SavedSession read_saved_session(const SessionFolder& folder, std::optional<uint64_t> recorded);

}  // namespace truestep
