// The recordings that a data folder holds, also of sessions that are gone. NAME.vtkhdf is the recording,
// NAME.vtkhdf.json says whose it is and what became of it. A session's first recording is named like the
// session, later ones ID.2, ID.3 ...: no name is used twice as long as anything of that name is there.
#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/sinks/recording/recording_sink.h"
#include "server/net/message.h"

namespace truestep {

struct RecordingLimits {
  double most_bytes = 0;                     ///< of all; then no new ones begin. 0: no limit
  std::optional<std::chrono::seconds> keep;  ///< finished ones go at this age; none: they stay
};

/// What became of a recording.
enum class RecordingFate : uint8_t {
  live,        ///< is being written
  finished,    ///< complete
  closed,      ///< complete up to where its session was unloaded or its server ended; the session may go on
  repaired,    ///< its server died; every frame that was durable is there
  incomplete,  ///< writing it failed (`note` says why); every frame that was durable is there
  damaged,     ///< cannot be read
};
const char* state_name(RecordingFate state);

struct RecordingFacts {
  std::string id, session, owner, title;
  int64_t created = 0;  ///< s since 1970
  RecordingFate state = RecordingFate::live;
  uint64_t frames = 0;
  double bytes = 0;
  std::string note;
};

/// A recording's name: a session's id, with a number from 2 on behind a dot for later ones.
bool is_recording_id(std::string_view text);

class RecordingCatalogue {
 public:
  /// `folder` is empty where nothing is recorded.
  RecordingCatalogue(std::filesystem::path folder, RecordingLimits limits);
  bool on() const { return !folder_.empty(); }

  /// Reads what earlier servers left; `repair` then brings what they did not finish into order.
  void read_folder();
  void repair(RecordingThread& thread);

  /// Takes a new name for a recording of the session. Error "quota_exceeded", "disk_full", "recording_io".
  RecordingFacts begin(const std::string& session, const std::string& owner, const std::string& title);
  /// Who writes it.
  void attach(const std::string& id, std::weak_ptr<const RecordingSink> sink);
  /// It came to nothing: the name is free again.
  void forget(const std::string& id);
  void end(const std::string& id, RecordingFate state, uint64_t frames, const std::string& note);

  /// Whether nobody has said yet what became of it.
  bool live(const std::string& id) const;
  /// Error "not_found", also for one that the caller may not see.
  RecordingFacts find(std::string_view id, const net::Caller& caller) const;
  /// A session's recordings, the last one first.
  std::vector<RecordingFacts> of_session(const std::string& session) const;
  /// The last of a session's recordings.
  std::optional<RecordingFacts> newest(const std::string& session) const;
  std::vector<RecordingFacts> list(std::string_view after, size_t limit, const net::Caller& caller) const;
  /// Error "conflict" while it is being written.
  void remove(const std::string& id);
  std::filesystem::path path(const std::string& id) const { return folder_ / (id + ".vtkhdf"); }
  /// Removes what is older than it is kept.
  void sweep();

 private:
  struct Row {
    RecordingFacts facts;
    std::weak_ptr<const RecordingSink> sink;
  };
  RecordingFacts present(const Row& row) const;
  void write_note(const RecordingFacts& facts) const;
  void settle(Row& row, RecordingThread& thread);
  void remove_files(const std::string& id) const;

  const std::filesystem::path folder_;
  const RecordingLimits limits_;
  mutable std::mutex mutex_;
  std::map<std::string, Row, std::less<>> rows_;
};

}  // namespace truestep
