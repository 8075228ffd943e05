// What a client asked a session to do, in the order of asking: to step on, to go to a step, or something that
// has to come between two steps.
#pragma once
#include <atomic>
#include <deque>
#include <exception>
#include <functional>
#include <memory>

#include "server/net/async.h"

namespace truestep {

struct SessionEntry;

using Aim = std::function<uint64_t(SessionEntry&)>;

struct Job {
  enum class Kind : uint8_t { step, seek, call };
  enum class End : uint8_t { none, reached, failed, cancelled, threw };

  Kind kind = Kind::call;
  // Under the entry's lock, with no step in progress; may throw.
  Aim aim;  ///< the step to reach, asked when the turn has come
  std::function<void(SessionEntry&)> call;
  std::function<void(const Job&)> after;  ///< may be empty; told of the end

  std::atomic<bool> cancelled{false};  ///< any thread: ends soon
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

  // Below: written once by the worker, before `done` is raised.
  std::atomic<End> end{End::none};
  std::exception_ptr error;
  net::Signal done;

  // The worker's own.
  bool begun = false;
  uint64_t target = 0;
  double used = 0;  ///< s of computing so far
};

using JobPtr = std::shared_ptr<Job>;

/// All that was asked of one session and has not ended; guarded by the entry's lock.
struct JobQueue {
  std::deque<JobPtr> calls;  ///< come before the next step
  std::deque<JobPtr> runs;
  bool scheduled = false;                              ///< a turn is waiting or running
  bool wary = false;                                   ///< the last step took longer than anybody thought
  double used = 0;                                     ///< weighted s, what turns are ordered by
  uint64_t due = 0;                                    ///< steps that playing asks for and that are not done
  std::chrono::steady_clock::time_point clock;         ///< up to which playing has been accounted for
  std::shared_ptr<boost::asio::steady_timer> waiting;  ///< for the next step of playing
  std::shared_ptr<boost::asio::steady_timer> leaving;  ///< for a viewer to come back
};

}  // namespace truestep
