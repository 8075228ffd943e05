// A session as the server holds it: the engine's session behind a mutex, a signal for waiting clients, and
// what HTTP needs around it. Hold `mutex` for everything except the atomics and the constants.
#pragma once
#include <atomic>
#include <boost/json.hpp>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "engine/base/interrupt.h"
#include "engine/session/session.h"
#include "server/net/http/message.h"
#include "server/sessions/fair_mutex.h"
#include "server/sessions/job.h"
#include "server/sessions/memory_budget.h"
#include "server/sessions/poll_sink.h"
#include "server/stream/encoded_frames.h"
#include "server/tasks/offload.h"
#include "server/tasks/signal.h"

namespace truestep {

using Clock = std::chrono::steady_clock;

/// The last answer to GET frame, valid until the session changes.
struct CachedAnswer {
  std::string key;       ///< query and media type that it answers
  uint64_t version = 0;  ///< SessionEntry::version at which it was made
  net::SharedBuffer body;
  std::string content_type, etag;
};

class RecordingSink;
class TrailSink;
class SessionKeeper;

/// How a session came back from disk.
struct Restored {
  uint64_t from_step = 0, step = 0;  ///< step of the saved state, and the step reached by replaying from it
  bool complete = true;              ///< false: the session had got further, and that part is lost
};

/// A snapshot kept for a client.
struct Snapshot {
  Snapshot(WorldState state, MemoryBudget::Lease lease) : state(std::move(state)), lease(std::move(lease)) {}
  WorldState state;
  MemoryBudget::Lease lease;
};

struct SessionEntry {
  SessionEntry(std::string id, std::shared_ptr<const World> world, std::shared_ptr<const ThreadArena> arena,
               MemoryBudget& budget, MemoryBudget::Lease lease)
      : id(std::move(id)),
        lease(std::move(lease)),
        past(budget.lease(0, "the past")),
        kept(budget.lease(0, "what is kept")),
        session(std::move(world), std::move(arena),
                {.history_room = [this](size_t bytes) { return past.resize(static_cast<double>(bytes)); }}) {}

  const std::string id;
  std::string owner;                ///< name of the key that created it; set before the session becomes
                                    ///< visible
  const MemoryBudget::Lease lease;  ///< of world, state and workspace
  const Clock::time_point created = Clock::now();
  uint64_t scene_hash = 0;       ///< of the document it was created from (PUT is idempotent)
  boost::json::object accuracy;  ///< how the method was chosen; empty unless the scene asks for accuracy
  std::atomic<Clock::rep> last_used{Clock::now().time_since_epoch().count()};
  std::atomic<int> streams{0};       ///< open WebSockets
  std::atomic<bool> removed{false};  ///< taken out of the store; its jobs stop
  std::atomic<bool> deleted{false};  ///< by a client: set before anything of it goes
  std::atomic<uint64_t> version{1};  ///< grows whenever the state or its past changes
  Signal changed;                    ///< notified together with `version`

  FairMutex mutex;
  MemoryBudget::Lease past;  ///< of the snapshots kept for seeking; without room, fewer are kept
  MemoryBudget::Lease kept;  ///< of journal, series and frames, booked as they grow
  Session session;
  std::map<std::string, std::shared_ptr<const Snapshot>> snapshots;
  std::shared_ptr<TrailSink> trails;         ///< null: the scene has none
  std::shared_ptr<PollSink> poll;            ///< keeps frames for clients that poll
  std::shared_ptr<RecordingSink> recording;  ///< null: the scene asks for none, or it has ended
  std::string recording_id;                  ///< id of that recording
  std::shared_ptr<SessionKeeper> keeper;     ///< null: not kept on disk
  std::optional<Restored> restored;
  std::map<std::string, uint64_t> stored_snapshots;  ///< snapshots on disk that are not loaded, by id, with
                                                     ///< their steps
  CachedAnswer cached_frame;
  EncodedFrames encoded;  ///< of the newest streamed frame

  // Used by the runner.
  JobQueue jobs;
  Interrupt interrupt;  ///< of the step in progress; raised under the lock or by the watchdog
  Clock::time_point profiled_until;
  bool keep_running = false;      ///< keep playing when nobody is watching
  bool recording_failed = false;  ///< and clients were told
  bool paused_unwatched = false;  ///< paused because nobody was watching, and not played since
  double estimated_step = 0;      ///< s, used until the first step has been measured

  /// Somebody is watching, over a stream or by polling.
  bool watched() const { return streams > 0 || (poll && !poll->expired()); }
  /// Playing starts or continues at a client's request; under the lock.
  void played(bool keep) {
    keep_running = keep || session.world().scene().header.keep_running;
    paused_unwatched = false;
    if (jobs.leaving && (keep_running || streams == 0)) jobs.leaving->cancel(), jobs.leaving.reset();
  }
  void touch() { last_used.store(Clock::now().time_since_epoch().count(), std::memory_order_relaxed); }
  /// Keeps profiling on for `time`; clients that read profiles renew it. Under the lock, between steps.
  void profile_for(std::chrono::seconds time) {
    profiled_until = Clock::now() + time;
    if (!session.computing_aside()) session.start_profiling();
  }
  /// f(entry) under the lock. Error "unknown_session" when a client deletes the session before or meanwhile.
  template <class F>
  auto use(const F& f) {
    require_there();
    try {
      return f(*this);
    } catch (const Error& e) {
      // Its folder has gone under it.
      if (e.code() == "folder_io") require_there();
      throw;
    }
  }
  void require_there() const {
    if (deleted) throw Error("unknown_session", "there is no session with this id");
  }
  /// After a batch of steps, under the lock: reports memory use to the budget, stops profiling that nobody
  /// reads, and says so when the recording has ended for want of room.
  void settle();
  /// Before a client is told of the present step: makes it survive the process. Under the lock.
  void acknowledge();
  /// Whether that would do nothing.
  bool acknowledged() const;
  /// Call after every change, with or without the lock.
  void publish() {
    version.fetch_add(1, std::memory_order_release);
    changed.notify();
  }
};

using EntryPtr = std::shared_ptr<SessionEntry>;

}  // namespace truestep
