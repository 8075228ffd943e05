// All sessions of a server: created within limits, found by id and owner, removed when unused for long.
#pragma once
#include <boost/json.hpp>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "engine/scene/admission.h"
#include "server/sessions/creation.h"
#include "server/sessions/entry.h"
#include "server/sessions/memory_budget.h"
#include "server/sessions/session_id.h"

namespace truestep {

struct StoreLimits {
  size_t max_sessions = 10000;
  double max_memory_bytes = 8e9;  ///< of sessions, studies and everything else that is large
  AdmissionLimits per_session;
  std::chrono::seconds idle_ttl{3600};  ///< a session unused, not playing and without a stream for this long
                                        ///< is removed
  int threads_per_session = 1;
  double accuracy_seconds = 2;  ///< CPU time for choosing a method for "accuracy"
};

class SessionArchive;

class SessionStore {
 public:
  /// `archive`, which keeps sessions on disk, may be null.
  SessionStore(StoreLimits limits, MemoryBudget& budget, SessionArchive* archive);

  /// How a scene's "accuracy" is treated: a method is chosen by measuring, or the scene comes from a session
  /// where that has been done and runs as it is.
  enum class Accuracy : uint8_t { choose, chosen };

  /// Reserves an id for a document, known by its hash. An id that exists with the same document is returned
  /// as it is (`ended` if it is already a session, `stored` if it is on disk and the caller must load it);
  /// with a different document, Error "conflict". Error "quota_exceeded".
  struct Begun {
    CreationPtr creation;
    enum class How : uint8_t { anew, before, stored } how = How::anew;
  };
  Begun begin(const std::string& id, uint64_t scene_hash, const net::Caller& owner);
  /// Builds the world and the session, calls `prepare` before the session becomes visible, and ends the
  /// creation (with scene_invalid, too_large, quota_exceeded or whatever `prepare` threw). Takes as long as
  /// the scene needs.
  void make(const CreationPtr& creation, SceneDraft draft, Accuracy accuracy,
            const std::function<void(SessionEntry&)>& prepare);
  /// Both, in the calling thread; returns the new session.
  EntryPtr create(const boost::json::value& document, const std::string& id, const net::Caller& owner,
                  Accuracy accuracy, const std::function<void(SessionEntry&)>& prepare);
  /// A creation in progress or one that failed recently; null when there is none, or none that this caller
  /// may see.
  CreationPtr creation(std::string_view id, const net::Caller& caller) const;
  /// Ends a creation that failed before make().
  void fail(const CreationPtr& creation, std::exception_ptr error);
  /// Stops and forgets a creation.
  void forget(const CreationPtr& creation);
  /// Asks all creations to stop.
  void cancel_creations();

  /// The session; null when it is on disk or being loaded or unloaded: `load` returns what to wait for. Error
  /// "unknown_session" (also for a session that the caller may not see), "creating", or "session_expired"
  /// when it was removed because it was unused.
  EntryPtr find(std::string_view id, const net::Caller& caller);
  /// The creation that loads such a session; `stored` when the caller must make it. Errors as for `begin`.
  Begun load(std::string_view id, const net::Caller& caller);
  /// Removes a session.
  EntryPtr remove(EntryPtr entry);
  /// Ids of the sessions that the caller may see, loaded or not, in order, starting after `after`.
  std::vector<std::string> list(std::string_view after, size_t limit, const net::Caller& caller) const;
  std::vector<EntryPtr> all() const;
  size_t size() const;
  /// Removes sessions that have been idle for too long. The caller must call `unloaded` for each; until then,
  /// clients asking for the session wait.
  std::vector<EntryPtr> expire();
  void unloaded(const EntryPtr& entry);
  const StoreLimits& limits() const { return limits_; }

  /// Creates the folder of a new session. Error "disk_full" or "folder_io"; it would be lost with the
  /// process.
  void keep(SessionEntry& entry);

 private:
  void check_room() const;
  Begun begin_loading(const std::string& id, const std::string& owner, uint64_t scene_hash);
  EntryPtr build(Creation& creation, SceneDraft draft, Accuracy accuracy,
                 const std::function<void(SessionEntry&)>& prepare);
  StoreLimits limits_;
  MemoryBudget& budget_;
  SessionArchive* const archive_;
  std::shared_ptr<const ThreadArena> arena_;
  mutable std::mutex mutex_;
  std::map<std::string, EntryPtr, std::less<>> entries_;
  std::map<std::string, CreationPtr, std::less<>> creations_;
  std::map<std::string, std::string, std::less<>> expired_;  ///< owners by id
  std::deque<std::string> expired_order_;
};

}  // namespace truestep
