// The saved states and logs of one session on disk: which there are and which are still needed. A state is
// needed until a newer one stands that the session could go on from; a recording that goes on needs one from
// before its last durable frame, so that no frame is missing when the session is restored.
#pragma once
#include <functional>
#include <map>
#include <mutex>
#include <optional>

#include "server/persistence/record_log.h"
#include "server/persistence/saved_state.h"
#include "server/persistence/session_folder.h"

namespace truestep {

class StateFiles {
 public:
  /// The last step of a recording that goes on; none where none does.
  using Recorded = std::function<std::optional<uint64_t>()>;
  /// `states`, steps by number, are those that an earlier server left.
  StateFiles(SessionFolder folder, std::map<uint64_t, uint64_t> states);
  const SessionFolder& folder() const { return folder_; }

  /// Writes a state from which logs `number` and later lead on. Error "disk_full" or "folder_io".
  void write(uint64_t number, uint64_t step, const SavedState& state);
  /// Nothing before this state, which is written, counts any more.
  void begin_anew(uint64_t number);
  /// Adds a record to a log of the session. Error "disk_full" or "folder_io".
  void append(RecordLog& log, const LogRecord& record);
  /// Makes the state outlive a power cut and removes what is not needed.
  void settle(uint64_t number, uint64_t step, const Recorded& recorded);
  /// Nothing is written or removed from now on: the folder is another's, or gone.
  void abandon();

 private:
  const SessionFolder folder_;
  bool described_ = false;  ///< the description outlives a power cut; the writing thread's
  std::mutex mutex_;
  bool abandoned_ = false;
  std::map<uint64_t, uint64_t> states_;  ///< steps by number, of those that stand
  uint64_t first_ = 0;                   ///< what came before counts no more
};

}  // namespace truestep
