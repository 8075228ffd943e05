// The threads that advance sessions, in three lanes: short requests, playing, and anything slow (one step at
// a time, computed beside the state that readers see). Nothing here runs on a network thread, and no step
// holds a session's lock for longer than a reader would wait.
#pragma once
#include <array>
#include <atomic>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <functional>
#include <optional>

#include "engine/base/interrupt.h"
#include "server/sessions/entry.h"
#include "server/sessions/job.h"
#include "server/sessions/lane.h"

namespace truestep {

class Runner {
 public:
  /// `grace`: how long a session keeps playing after its last stream has closed; empty: for ever.
  Runner(int workers, std::optional<std::chrono::milliseconds> grace);
  ~Runner();

  /// For work of a few milliseconds at most.
  boost::asio::thread_pool& pool() { return pool_; }
  /// Runs f() on the drawing thread (there is one: a software renderer uses all cores by itself), unless the
  /// awaiting coroutine is cancelled first. Error "quota_exceeded" when too many pictures are waiting.
  template <class F>
  boost::asio::awaitable<std::invoke_result_t<F>> draw(F f);

  /// Starts the clock of a playing session. Call after Session::play, holding the entry's lock.
  void keep_playing(const EntryPtr& entry);
  /// The session's last stream has closed: unless somebody starts watching again, it pauses after the grace
  /// period. Under the entry's lock.
  void left_alone(const EntryPtr& entry);

  /// Steps (aloud, or silently for a seek) to the step that `aim` returns when the job's turn comes, in
  /// slices between which other sessions and readers of this one get their turn. Cancelled when the caller
  /// stops waiting. Exceptions from `aim` are rethrown here.
  boost::asio::awaitable<JobPtr> run_to(EntryPtr entry, Job::Kind kind, Aim aim);
  /// Runs f(entry) between two steps, under the lock; its exceptions are rethrown here.
  boost::asio::awaitable<JobPtr> call(EntryPtr entry, std::function<void(SessionEntry&)> f);
  /// Waits for the end of a job that was started.
  boost::asio::awaitable<JobPtr> end_of(EntryPtr entry, JobPtr job);
  /// Starts a job without waiting for it; `queue` expects the entry's lock to be held.
  JobPtr start(const EntryPtr& entry, JobPtr job);
  void queue(const EntryPtr& entry, const JobPtr& job);

  /// Cancels everything requested of the session, including a step in progress. Under the entry's lock.
  void interrupt(SessionEntry& entry);

  /// Runs f() on the threads for long work, under an Interrupt that is raised when the awaiting coroutine is
  /// cancelled or the service stops. Exceptions pass through.
  template <class F>
  boost::asio::awaitable<std::invoke_result_t<F>> long_work(F f);
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
  template <class F, class Start>
  boost::asio::awaitable<std::invoke_result_t<F>> work_elsewhere(F f, Start start);
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

  boost::asio::thread_pool pool_, picture_thread_;
  std::atomic<bool> stopping_{false};
  std::atomic<uint64_t> steps_{0};
  std::array<InPlace, 64> in_place_;
  std::atomic<bool> watching_{false};
  const std::optional<std::chrono::milliseconds> grace_;
  static constexpr int kMostPictures = 32;
  std::atomic<int> pictures_{0};  ///< waiting or being drawn
  boost::asio::steady_timer watch_timer_{pool_};
  std::mutex long_mutex_;
  std::vector<std::weak_ptr<Interrupt>> long_interrupts_;
  Lane express_, playing_, slow_;  ///< last, so that their threads end before anything they use
};

namespace runner_detail {
template <class T>
struct LongWork {
  std::shared_ptr<Interrupt> interrupt = std::make_shared<Interrupt>();
  net::Signal done;
  std::atomic<bool> ended{false};
  std::exception_ptr error;
  std::optional<T> value;
};
}  // namespace runner_detail

template <class F, class Start>
boost::asio::awaitable<std::invoke_result_t<F>> Runner::work_elsewhere(F f, Start start) {
  using T = std::invoke_result_t<F>;
  const auto work = std::make_shared<runner_detail::LongWork<T>>();
  {
    const std::lock_guard lock(long_mutex_);
    std::erase_if(long_interrupts_, [](const auto& w) { return w.expired(); });
    long_interrupts_.push_back(work->interrupt);
    if (stopping_) work->interrupt->raise();
  }
  const std::function<void()> run = [work, &f] {
    try {
      const InterruptScope scope(*work->interrupt);
      interruption_point();
      work->value.emplace(f());
    } catch (...) {
      work->error = std::current_exception();
    }
    work->ended = true;
    work->done.notify();
  };
  start(run);
  const auto ended = [work] { return work->ended.load(); };
  const auto give_up = [work] { work->interrupt->raise(); };
  co_await net::wait_for_end(work->done, ended, give_up);
  if (work->error) std::rethrow_exception(work->error);
  co_return std::move(*work->value);
}

template <class F>
boost::asio::awaitable<std::invoke_result_t<F>> Runner::long_work(F f) {
  const auto start = [this](const std::function<void()>& run) { start_long_work(run); };
  co_return co_await work_elsewhere(std::move(f), start);
}

template <class F>
boost::asio::awaitable<std::invoke_result_t<F>> Runner::draw(F f) {
  if (pictures_.fetch_add(1) >= kMostPictures) {
    --pictures_;
    throw Error("quota_exceeded", "too many pictures are being drawn; try again");
  }
  const auto start = [this](const std::function<void()>& run) {
    boost::asio::post(picture_thread_, [this, run] {
      run();
      --pictures_;
    });
  };
  co_return co_await work_elsewhere(std::move(f), start);
}

}  // namespace truestep
