// The sessions in a data folder, loaded or not: who may see them, how much space they take, and how long
// unused ones stay.
#pragma once
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/net/http/message.h"
#include "server/persistence/sessions/saved_session.h"
#include "server/persistence/sessions/session_keeper.h"

namespace truestep {

struct ArchiveLimits {
  std::chrono::seconds keep{7 * 24 * 3600};  ///< how long an unused session stays
  double most_bytes = 1e10;                  ///< in total; beyond this the longest unused go
};

class SessionArchive {
 public:
  /// Reads what earlier servers left below `folder`, which is created if missing; removes folders that were
  /// being created or removed. Error "folder_io".
  SessionArchive(Place folder, ArchiveLimits limits, MemoryBudget& memory);

  /// Contents that cannot be used, one sentence each.
  const std::vector<std::string>& damage() const { return damage_; }
  std::optional<SessionAbout> find(std::string_view id) const;
  /// Ids that the caller may see, in order, after `after`.
  std::vector<std::string> list(std::string_view after, size_t limit, const net::Caller& caller) const;

  /// Creates the folder of a new session. Error "disk_full" or "folder_io".
  std::shared_ptr<SessionKeeper> keep(const SessionAbout& about, const Session& session,
                                      const boost::json::object& accuracy);
  /// What to restore a session from; `recorded` as for read_saved_session.
  SavedSession read(const std::string& id, std::optional<uint64_t> recorded);
  /// Continues to keep a session restored from that.
  std::shared_ptr<SessionKeeper> keep_on(const SavedSession& saved, const Session& session);
  /// The session is no longer in memory, or never got there after `read`.
  void unloaded(const std::string& id);
  /// Error "folder_io" when it cannot be removed; it then stays.
  void remove(const std::string& id);
  SessionFolder folder_of(const std::string& id) const { return SessionFolder(root_ / id); }

  /// Error "quota_exceeded" when there is no room for this many more bytes.
  void require_room(double bytes) const;
  /// Removes sessions that are not loaded and too old, or too many; returns their ids.
  std::vector<std::string> sweep();

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Row {
    SessionAbout about;
    double bytes = 0;
    bool surveyed = false;                ///< `bytes` and `used` are known
    bool loading = false;                 ///< between `read` and `keep_on`
    Time used{};                          ///< last use; counts while it is not loaded
    std::weak_ptr<SessionKeeper> keeper;  ///< of a loaded one
  };
  void survey(const std::string& id);
  std::shared_ptr<SessionKeeper> add(SessionFolder folder, const SessionAbout& about, const Session& session,
                                     SessionKeeper::Beginning beginning);

  const Place root_;
  const ArchiveLimits limits_;
  MemoryBudget& memory_;
  OpenFiles files_;
  StateWriter writer_;
  std::vector<std::string> damage_;
  mutable std::mutex mutex_;
  std::map<std::string, Row, std::less<>> rows_;
};

}  // namespace truestep
