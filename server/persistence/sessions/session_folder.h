// The folder of a session below sessions/ of the data folder:
//   about             a line of JSON about the session, then the scene as it runs, one JSON document
//   state.N.STEP      a state that was saved (saved_state.h), at that step
//   log.N             what happened since state N, or since log N - 1 (record_log.h)
//   snapshots/ID.STEP states that clients keep (engine/session/snapshot/snapshot.h)
// A folder appears and disappears as a whole, by a rename.
#pragma once
#include <boost/json.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/session/snapshot/sealed.h"
#include "server/persistence/place.h"

namespace truestep {

struct SessionAbout {
  std::string id, owner, title;
  uint64_t scene_hash = 0;  ///< of the document it was created from
  int64_t created = 0;      ///< s since 1970
};

class SessionFolder {
 public:
  explicit SessionFolder(Place place) : place_(std::move(place)) {}
  /// Creates the folder below `root`. Error "disk_full" or "folder_io".
  static SessionFolder create(const Place& root, const SessionAbout& about, const boost::json::object& scene,
                              const boost::json::object& accuracy);
  /// Moves the folder away at once, then removes its files. Error "folder_io" when it is still there.
  void remove() const;

  const Place& place() const { return place_; }
  /// Only the first line. Error "session_damaged" or "folder_io", as for all readers.
  SessionAbout about() const;
  /// Of what a restore reads: description, states and logs, without the snapshots.
  double bytes_to_read() const;
  struct Scene {
    boost::json::value document;
    boost::json::object accuracy;
  };
  Scene scene() const;

  Place about_place() const { return place_ / "about"; }
  Place state_place(uint64_t number, uint64_t step) const;
  Place log_place(uint64_t number) const;
  /// What the folder holds, by number; `states` with their steps.
  struct Contents {
    std::map<uint64_t, uint64_t> states;
    std::vector<uint64_t> logs;
  };
  Contents contents() const;

  // --- snapshots that clients keep
  void keep_snapshot(const std::string& sid, uint64_t step, std::span<const std::byte> file) const;
  std::map<std::string, uint64_t> snapshots() const;  ///< steps by id
  Bytes snapshot(const std::string& sid, uint64_t step) const;

 private:
  Place place_;
};

}  // namespace truestep
