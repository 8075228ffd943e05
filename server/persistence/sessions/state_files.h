// The saved states and logs of one session on disk: which exist and which are still needed. A state is needed
// until there is a newer one that the session could continue from; a recording that continues needs one from
// before its last durable frame, so that no frame is missing after a restore.
#pragma once
#include <functional>
#include <map>
#include <mutex>
#include <optional>

#include "server/persistence/record_log.h"
#include "server/persistence/sessions/saved_state.h"
#include "server/persistence/sessions/session_folder.h"

namespace truestep {

class StateFiles {
 public:
  /// The last step of a recording that continues; empty when there is none.
  using Recorded = std::function<std::optional<uint64_t>()>;
  /// `states`, steps by number, are those left by an earlier server.
  StateFiles(SessionFolder folder, std::map<uint64_t, uint64_t> states);
  const SessionFolder& folder() const { return folder_; }

  /// Writes a state that logs `number` and later continue. Error "disk_full" or "folder_io".
  void write(uint64_t number, uint64_t step, const SavedState& state);
  /// Nothing before this state, which has been written, counts any more.
  void begin_anew(uint64_t number);
  /// Appends a record to a log of the session. Error "disk_full" or "folder_io".
  void append(RecordLog& log, const LogRecord& record);
  /// Makes the state survive a power cut and removes what is no longer needed.
  void settle(uint64_t number, uint64_t step, const Recorded& recorded);
  /// From now on nothing is written or removed: the folder belongs to another keeper, or is gone.
  void abandon();

 private:
  const SessionFolder folder_;
  bool described_ = false;  ///< the description survives a power cut; used by the writer thread only
  std::mutex mutex_;
  bool abandoned_ = false;
  std::map<uint64_t, uint64_t> states_;  ///< steps by number of the states that exist
  uint64_t first_ = 0;                   ///< everything before this number is obsolete
};

}  // namespace truestep
