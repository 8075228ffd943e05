// The sessions that a data folder keeps, loaded or not: who may see them, what they take, and how long those
// that nobody uses stay.
#pragma once
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/net/message.h"
#include "server/persistence/saved_session.h"
#include "server/persistence/session_keeper.h"

namespace truestep {

struct ArchiveLimits {
  std::chrono::seconds keep{7 * 24 * 3600};  ///< an unused session stays for so long
  double most_bytes = 1e10;                  ///< of all; beyond it those unused longest go
};

class SessionArchive {
 public:
  /// Reads what earlier servers left below `folder`, which is made; removes what they had begun to make or
  /// to remove. Error "folder_io".
  SessionArchive(std::filesystem::path folder, ArchiveLimits limits, MemoryBudget& memory);

  /// What of that cannot be used, a sentence each.
  const std::vector<std::string>& damage() const { return damage_; }
  std::optional<SessionAbout> find(std::string_view id) const;
  /// Ids that the caller may see, in their order, after `after`.
  std::vector<std::string> list(std::string_view after, size_t limit, const net::Caller& caller) const;

  /// Makes the folder of a new session. Error "disk_full" or "folder_io".
  std::shared_ptr<SessionKeeper> keep(const SessionAbout& about, const Session& session,
                                      const boost::json::object& accuracy);
  /// What there is to restore a session from; `recorded` as for read_saved_session.
  SavedSession read(const std::string& id, std::optional<uint64_t> recorded);
  /// Of a session that was restored from that.
  std::shared_ptr<SessionKeeper> keep_on(const SavedSession& saved, const Session& session);
  /// The session is not in memory any more, or did not get there after `read`.
  void unloaded(const std::string& id);
  void remove(const std::string& id);
  SessionFolder folder_of(const std::string& id) const { return SessionFolder(root_ / id); }

  /// Error "quota_exceeded" when there is no room for so many bytes more.
  void require_room(double bytes) const;
  /// Removes sessions that are not loaded and too old, or too many, and returns their ids.
  std::vector<std::string> sweep();

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Row {
    SessionAbout about;
    double bytes = 0;
    bool surveyed = false;                ///< `bytes` and `used` are known
    bool loading = false;                 ///< between `read` and `keep_on`
    Time used{};                          ///< counts while it is not loaded
    std::weak_ptr<SessionKeeper> keeper;  ///< of a loaded one
  };
  void survey(const std::string& id);
  std::shared_ptr<SessionKeeper> add(SessionFolder folder, const SessionAbout& about, const Session& session,
                                     SessionKeeper::Beginning beginning);

  const std::filesystem::path root_;
  const ArchiveLimits limits_;
  MemoryBudget& memory_;
  OpenFiles files_;
  StateWriter writer_;
  std::vector<std::string> damage_;
  mutable std::mutex mutex_;
  std::map<std::string, Row, std::less<>> rows_;
};

}  // namespace truestep
