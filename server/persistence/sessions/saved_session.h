// A session as read from its folder: the state to restore from and what happened since. This is the newest
// readable state, or an older one when a recording needs steps from before it; the logs lead from any of them
// to where the session was.
#pragma once
#include <optional>

#include "server/persistence/record_log.h"
#include "server/persistence/sessions/saved_state.h"
#include "server/persistence/sessions/session_folder.h"

namespace truestep {

/// The result of following the logs after a state.
struct LoggedCourse {
  std::vector<JournalEntry> journal;        ///< from the state on, including commands of a future that a seek
                                            ///< went back from
  std::optional<JournalEntry> unconfirmed;  ///< the newest command, if nothing confirms that it was carried
                                            ///< out
  uint64_t step = 0;                        ///< the last step known to have been reported
  uint64_t furthest = 0;                    ///< the largest step ever reported
  uint64_t last_sequence = 0;
};
/// `from` is the state's step. Error "session_damaged" when the records contradict each other.
LoggedCourse follow(const SavedState& state, uint64_t from, std::span<const LogRecord> records);

struct SavedSession {
  SessionAbout about;
  SessionFolder::Scene scene;
  Bytes snapshot;  ///< empty: the start of the scene
  uint64_t from_step = 0;
  LoggedCourse course;
  uint64_t next_number = 1;  ///< of the next log or state to be written
  /// False when part of what the session did is unreadable, so that it resumes at an earlier step.
  bool complete = true;
};

/// `recorded` is the last step of a recording that continues. Error "session_damaged" or "folder_io".
SavedSession read_saved_session(const SessionFolder& folder, std::optional<uint64_t> recorded);

}  // namespace truestep
