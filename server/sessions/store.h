// All sessions of a server: created under limits, found by id and owner, forgotten when nobody has used them
// for long.
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
  double max_memory_bytes = 8e9;  ///< of sessions, studies and whatever else is large
  AdmissionLimits per_session;
  std::chrono::seconds idle_ttl{3600};  ///< unused, not playing, no stream for so long: removed
  int threads_per_session = 1;
  double accuracy_seconds = 2;  ///< CPU time that choosing a method for "accuracy" may take
};

class SessionArchive;

class SessionStore {
 public:
  /// `archive`, which keeps sessions on disk, may be null.
  SessionStore(StoreLimits limits, MemoryBudget& budget, SessionArchive* archive);

  /// What becomes of a scene's "accuracy": a method is chosen by measuring, or the scene comes from a session
  /// where that was done and runs as it is.
  enum class Accuracy : uint8_t { choose, chosen };

  /// Takes an id for a document. An id that exists with the same document is given as it is (`ended` already
  /// when it is a session, `stored` when it is one on disk that the caller is now to load); with another one
  /// it is Error "conflict". Error quota_exceeded.
  struct Begun {
    CreationPtr creation;
    enum class How : uint8_t { anew, before, stored } how = How::anew;
  };
  Begun begin(const std::string& id, const boost::json::value& document, const net::Caller& owner);
  /// Builds the world and the session, calls `prepare` before anybody can see it, and ends the creation (with
  /// scene_invalid, too_large, quota_exceeded or what `prepare` threw). Takes as long as the scene needs.
  void make(const CreationPtr& creation, SceneDraft draft, Accuracy accuracy,
            const std::function<void(SessionEntry&)>& prepare);
  /// Both, in the calling thread: the new session.
  EntryPtr create(boost::json::value document, const std::string& id, const net::Caller& owner,
                  Accuracy accuracy, const std::function<void(SessionEntry&)>& prepare);
  /// One that goes on or has failed not long ago; null where there is none, or none for this caller.
  CreationPtr creation(std::string_view id, const net::Caller& caller) const;
  /// Ends one that failed before it could be made.
  void fail(const CreationPtr& creation, std::exception_ptr error);
  /// Stops and forgets it.
  void forget(const CreationPtr& creation);
  /// Tells all that are being made to stop.
  void cancel_creations();

  /// The session; null when it is on disk or on its way from or to there: `load` says what to wait for. Error
  /// "unknown_session", also for a session that the caller may not see, "creating", or "session_expired" when
  /// it was removed for want of use.
  EntryPtr find(std::string_view id, const net::Caller& caller);
  /// What brings such a session into memory; `stored` when the caller is to make it. Errors as for `begin`.
  Begun load(std::string_view id, const net::Caller& caller);
  /// Takes a session out.
  EntryPtr remove(EntryPtr entry);
  /// Ids of sessions that the caller may see, loaded or not, in their order, starting after `after`.
  std::vector<std::string> list(std::string_view after, size_t limit, const net::Caller& caller) const;
  std::vector<EntryPtr> all() const;
  size_t size() const;
  /// Takes out what has been idle for too long. `unloaded` must follow for each: until then those who ask for
  /// the session wait.
  std::vector<EntryPtr> expire();
  void unloaded(const EntryPtr& entry);
  const StoreLimits& limits() const { return limits_; }

 private:
  void check_room() const;
  Begun begin_loading(const std::string& id, const std::string& owner, uint64_t scene_hash);
  void keep(SessionEntry& entry);
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
