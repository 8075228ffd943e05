// What a client asked a session to do, in order: advance, go to a step, or run something between two steps.
#pragma once
#include <atomic>
#include <deque>
#include <exception>
#include <functional>
#include <memory>

#include "server/tasks/signal.h"

namespace truestep {

struct SessionEntry;

using Aim = std::function<uint64_t(SessionEntry&)>;

struct Job {
  enum class Kind : uint8_t { step, seek, call };
  enum class End : uint8_t { none, reached, failed, cancelled, threw };

  Kind kind = Kind::call;
  // Under the entry's lock, with no step in progress; may throw.
  Aim aim;  ///< the step to reach, evaluated when the job's turn comes
  std::function<void(SessionEntry&)> call;
  std::function<void(SessionEntry&)>
      reached;                            ///< may be empty; at the step to reach, before anybody else's turn
  std::function<void(const Job&)> after;  ///< may be empty; called when the job has ended

  std::atomic<bool> cancelled{false};  ///< set by any thread; the job ends soon
  static std::shared_ptr<Job> run(Kind kind, Aim aim) {
    auto job = std::make_shared<Job>();
    job->kind = kind;
    job->aim = std::move(aim);
    return job;
  }
  static std::shared_ptr<Job> between_steps(std::function<void(SessionEntry&)> call) {
    auto job = std::make_shared<Job>();
    job->call = std::move(call);
    return job;
  }

  // Below: written once by the worker, before `done` is notified.
  std::atomic<End> end{End::none};
  std::exception_ptr error;
  Signal done;

  // Only the worker touches these.
  bool begun = false;
  uint64_t target = 0;
  double used = 0;  ///< s of computing time so far
};

using JobPtr = std::shared_ptr<Job>;

/// Jobs of one session that have not ended; guarded by the entry's lock.
struct JobQueue {
  std::deque<JobPtr> calls;  ///< run before the next step
  std::deque<JobPtr> runs;
  /// The present step is one on the way to another.
  bool seeking() const {
    return !runs.empty() && runs.front()->kind == Job::Kind::seek && runs.front()->begun;
  }
  bool scheduled = false;                       ///< a turn is queued or running
  bool wary = false;                            ///< the last step took unexpectedly long
  double used = 0;                              ///< weighted s; turns are ordered by it
  uint64_t due = 0;                             ///< steps that playing still owes
  std::chrono::steady_clock::time_point clock;  ///< time up to which playing has been accounted for
  TimerPtr waiting;                             ///< until the next step of playing
  TimerPtr leaving;                             ///< until a viewer comes back
};

}  // namespace truestep
