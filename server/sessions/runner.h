// The threads that advance sessions, in three lanes: short requests, playing, and anything slow (one step at
// a time, computed beside the state that readers see). Nothing here runs on a network thread, and no step
// holds a session's lock for longer than a reader would wait.
#pragma once
#include <array>
#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "engine/base/interrupt.h"
#include "server/net/worker_pool.h"
#include "server/sessions/entry.h"
#include "server/sessions/job.h"
#include "server/sessions/lane.h"
#include "server/tasks/task.h"

namespace truestep {

class Runner {
 public:
  /// `grace`: how long a session keeps playing after its last stream has closed; empty: for ever.
  Runner(int workers, std::optional<std::chrono::milliseconds> grace);
  ~Runner();

  /// For work of a few milliseconds at most.
  net::WorkerPool& pool() { return pool_; }
  /// Runs f() on the drawing thread (there is one: a software renderer uses all cores by itself), unless the
  /// awaiting coroutine is cancelled first. Error "quota_exceeded" when too many pictures are waiting.
  Task<net::Response> draw(std::function<net::Response()> f);

  /// Starts the clock of a playing session. Call after Session::play, holding the entry's lock.
  void keep_playing(const EntryPtr& entry);
  /// The session's last stream has closed: unless somebody starts watching again, it pauses after the grace
  /// period. Under the entry's lock.
  void left_alone(const EntryPtr& entry);

  /// Steps (aloud, or silently for a seek) to the step that `aim` returns when the job's turn comes, in
  /// slices between which other sessions and readers of this one get their turn. Cancelled when the caller
  /// stops waiting. `reached` is called at that step, before anybody else's turn. Exceptions from both are
  /// rethrown here.
  Task<JobPtr> run_to(EntryPtr entry, Job::Kind kind, Aim aim,
                      std::function<void(SessionEntry&)> reached = nullptr);
  /// Runs f(entry) between two steps, under the lock; its exceptions are rethrown here.
  Task<JobPtr> call(EntryPtr entry, std::function<void(SessionEntry&)> f);
  /// Waits for the end of a job that was started.
  Task<JobPtr> end_of(EntryPtr entry, JobPtr job);
  /// Starts a job without waiting for it; `queue` expects the entry's lock to be held.
  JobPtr start(const EntryPtr& entry, JobPtr job);
  void queue(const EntryPtr& entry, const JobPtr& job);

  /// Cancels everything requested of the session, including a step in progress. Under the entry's lock.
  void interrupt(SessionEntry& entry);

  /// Runs f() on the threads for long work, under an Interrupt that is raised when the awaiting coroutine is
  /// cancelled or the service stops. Exceptions pass through; Error "too_large" when it computes for longer
  /// than `within`.
  template <class F>
  Task<std::invoke_result_t<F>> long_work(F f, std::optional<std::chrono::seconds> within = {});
  /// The same for work that nobody waits for.
  void start_long_work(const std::function<void()>& f);

  /// Asks all work to stop; jobs end as cancelled.
  void cancel_all(const std::vector<EntryPtr>& entries);
  /// Finishes what lanes and pools still hold, then joins their threads.
  void join();

  uint64_t steps_done() const { return steps_.load(std::memory_order_relaxed); }

 private:
  enum class LaneKind : uint8_t { express, playing, slow };
  enum class Next : uint8_t { step, silent_step, wait, nothing };

  Lane& lane(LaneKind kind) {
    return kind == LaneKind::express ? express_ : kind == LaneKind::playing ? playing_ : slow_;
  }
  static LaneKind lane_of(const SessionEntry& entry);
  enum class Threads : uint8_t { long_work, pictures };
  /// Runs f on these threads; for work that may refer to what the awaiting coroutine holds.
  Task<> work_elsewhere(std::function<void()> f, Threads threads,
                        std::optional<std::chrono::seconds> within = {});
  template <class T>
  Task<T> result_from_long_work(std::function<T()> f, std::optional<std::chrono::seconds> within);
  void schedule(const EntryPtr& entry);
  void turn(const EntryPtr& entry, LaneKind kind);
  Next next_of(SessionEntry& entry);
  StepOutcome one_step(const EntryPtr& entry, std::unique_lock<FairMutex>& lock, Session::Output output);
  void carry_out_calls(SessionEntry& entry);
  void cancel_jobs(SessionEntry& entry);
  void wait_for_clock(const EntryPtr& entry);
  /// Watchdog: while sessions work, interrupts steps that hold their session's lock for too long.
  void watch();

  struct InPlace {
    std::mutex mutex;
    EntryPtr entry;
    std::atomic<Clock::rep> since{0};
  };
  class UnderWatch;

  net::WorkerPool pool_, picture_thread_;
  std::atomic<bool> stopping_{false};
  std::atomic<uint64_t> steps_{0};
  std::array<InPlace, 64> in_place_;
  std::atomic<bool> watching_{false};
  const std::optional<std::chrono::milliseconds> grace_;
  static constexpr int kMostPictures = 32;
  std::atomic<int> pictures_{0};  ///< waiting or being drawn
  std::mutex long_mutex_;
  std::vector<std::weak_ptr<Interrupt>> long_interrupts_;
  Lane express_, playing_, slow_;  ///< last, so that their threads end before anything they use
};

template <class T>
Task<T> Runner::result_from_long_work(std::function<T()> f, std::optional<std::chrono::seconds> within) {
  std::optional<T> result;
  co_await work_elsewhere([&] { result.emplace(f()); }, Threads::long_work, within);
  co_return std::move(*result);
}

template <class F>
Task<std::invoke_result_t<F>> Runner::long_work(F f, std::optional<std::chrono::seconds> within) {
  // A std::function needs something that can be copied.
  const auto shared = std::make_shared<F>(std::move(f));
  return result_from_long_work<std::invoke_result_t<F>>([shared] { return (*shared)(); }, within);
}

}  // namespace truestep
