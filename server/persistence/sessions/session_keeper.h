// Makes a session outlive the process: a sink that logs each command before it is carried out, the step
// whenever a client is told of it, and now and then saves a state, so that restoring repeats little. Commands
// and steps are handed to the operating system at once (they survive the process, kill -9 included); a thread
// of its own makes states survive a power cut.
// What cannot be written (a full disk) never stops the session: it continues, reports that it is not kept,
// and is kept again from the next state that can be written.
#pragma once
#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "engine/session/session.h"
#include "engine/sinks/recording/recording_sink.h"
#include "server/persistence/record_log.h"
#include "server/persistence/sessions/state_files.h"
#include "server/persistence/sessions/state_writer.h"
#include "server/sessions/memory_budget.h"

namespace truestep {

/// What all keepers share.
struct KeepingMeans {
  OpenFiles& files;
  StateWriter& writer;
  MemoryBudget& memory;
};

class SessionKeeper final : public Sink {
 public:
  /// What the disk already holds of the session.
  struct Beginning {
    std::map<uint64_t, uint64_t> states;  ///< steps by number
    uint64_t next_number = 0;             ///< of a log or state
    uint64_t base_step = 0;               ///< of the state that the session came from
  };
  SessionKeeper(SessionFolder folder, const Session& session, Beginning beginning, const KeepingMeans& means);

  bool due(uint64_t) override { return false; }
  const FrameRequest& request() const override { return request_; }
  void accept(const FramePtr&) override {}
  void notify(std::string_view kind, uint64_t step, const std::string& detail) override;
  void before_command(const JournalEntry& entry) override;
  void command_refused(const JournalEntry& entry) override;

  // --- under the session's lock
  /// Keeps states from before the end of this recording.
  void keep_for(std::weak_ptr<const RecordingSink> recording) { recording_ = std::move(recording); }
  /// Logs the present step, because clients may be told of it, and tries again to keep what is not kept.
  void stands();
  /// The same before a client is told of a step in the midst of others, as quickly as possible: a present
  /// step that is logged or that no log can lead to costs nothing.
  void acknowledge();
  bool acknowledged() const;
  /// The session has stepped for this long (s of computing time).
  void worked(double seconds);
  /// Saves the present state, unless the steps since the last one are quickly repeated.
  void save();
  /// Saves the present state as the start of the session's history.
  void save_anew();
  /// Why the session is not being kept; empty when it is.
  const std::string& problem() const { return problem_; }

  // --- any thread
  const SessionFolder& folder() const { return files_->folder(); }
  /// Whether anything was written since the last call.
  bool take_written();
  /// The folder now belongs to another keeper, or is gone: nothing more is written to it.
  void abandon() { files_->abandon(); }

 private:
  struct Shared;  // shared with the writer thread
  bool write(const LogRecord& record);
  void lose(const Error& e);
  void begin_log(LogRecord::Kind first);
  bool due_to_save(double least_seconds) const;
  void save_beside();
  SavedState saved(Bytes snapshot) const;
  StateFiles::Recorded recorded() const;
  double seconds_to_write() const;

  const Session& session_;
  const KeepingMeans means_;
  const std::shared_ptr<StateFiles> files_;
  const FrameRequest request_;
  std::weak_ptr<const RecordingSink> recording_;
  uint64_t number_;
  std::optional<RecordLog> log_;
  LogRecord::Kind first_ = LogRecord::Kind::continues;  ///< of the log, which is created when needed
  uint64_t base_step_;                                  ///< step of the newest state
  std::optional<uint64_t> told_step_;
  double worked_ = 0;  ///< s of computing time since the newest state
  std::chrono::steady_clock::time_point told_at_{}, tried_at_{};
  std::string problem_, problem_code_;
  const std::shared_ptr<Shared> shared_;
};

}  // namespace truestep
