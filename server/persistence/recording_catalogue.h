// The recordings in a data folder, including those of removed sessions. NAME.vtkhdf is the recording,
// NAME.vtkhdf.json says whose it is and what became of it. A session's first recording bears the session's
// id, later ones are ID.2, ID.3 ...; no name is reused while any file of that name exists.
#pragma once
#include <boost/json.hpp>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/sinks/recording/recording_sink.h"
#include "server/net/http/message.h"
#include "server/persistence/place.h"

namespace truestep {

struct RecordingLimits {
  double most_bytes = 0;                     ///< in total; beyond this no new ones begin. 0: no limit
  std::optional<std::chrono::seconds> keep;  ///< finished recordings are removed at this age; empty: never
};

/// What became of a recording.
enum class RecordingFate : uint8_t {
  live,        ///< being written
  finished,    ///< complete
  closed,      ///< complete up to the point where its session was unloaded or its server stopped; the session
               ///< may continue
  repaired,    ///< its server was killed; every durable frame is there
  incomplete,  ///< writing failed (`note` says why); every durable frame is there
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
  boost::json::object asked;  ///< every, fields, precision of one begun by a request; empty: of the scene's
};

/// A recording's id: the session's id, with ".2", ".3" ... for later ones.
bool is_recording_id(std::string_view text);

class RecordingCatalogue {
 public:
  /// `folder` is nowhere when nothing is recorded.
  RecordingCatalogue(Place folder, RecordingLimits limits);
  bool on() const { return static_cast<bool>(folder_); }

  /// Reads what earlier servers left; `repair` then repairs what they did not finish.
  void read_folder();
  void repair(RecordingThread& thread);

  /// Reserves a new name for a recording of the session. Error "quota_exceeded", "disk_full", "recording_io".
  RecordingFacts begin(const std::string& session, const std::string& owner, const std::string& title,
                       boost::json::object asked);
  /// Sets the sink that writes it.
  void attach(const std::string& id, std::weak_ptr<const RecordingSink> sink);
  /// The recording has no frame: its name is free again.
  void forget(const std::string& id);
  void end(const std::string& id, RecordingFate state, uint64_t frames, const std::string& note);

  /// Whether the recording's fate is still open.
  bool live(const std::string& id) const;
  /// Error "not_found", also for a recording that the caller may not see.
  RecordingFacts find(std::string_view id, const net::Caller& caller) const;
  /// A session's recordings, newest first.
  std::vector<RecordingFacts> of_session(const std::string& session) const;
  /// The newest of a session's recordings.
  std::optional<RecordingFacts> newest(const std::string& session) const;
  std::vector<RecordingFacts> list(std::string_view after, size_t limit, const net::Caller& caller) const;
  /// Error "conflict" while it is being written.
  void remove(const std::string& id);
  Place place(const std::string& id) const { return folder_ / (id + ".vtkhdf"); }
  /// Removes recordings that have reached the age limit.
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

  const Place folder_;
  const RecordingLimits limits_;
  mutable std::mutex mutex_;
  std::map<std::string, Row, std::less<>> rows_;
};

}  // namespace truestep
