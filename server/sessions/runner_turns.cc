// Turns of a session: which lane it waits in, and what a worker does for it during its turn.
#include <algorithm>

#include "engine/base/log.h"
#include "server/persistence/sessions/session_keeper.h"
#include "server/sessions/runner.h"

namespace truestep {

namespace {

constexpr double kLate = 0.5;  // s for which playing owes a step
constexpr auto kSlice = std::chrono::milliseconds(5);
constexpr double kSlowStep = 0.01;      // s; slower steps are computed beside the state that readers see
constexpr double kShortRequest = 0.02;  // s of computing time up to which a request counts as short
constexpr double kUnwatched = 8;        // weight of a second when nobody is watching
constexpr auto kWatch = std::chrono::milliseconds(15);
constexpr auto kShortestWait = std::chrono::microseconds(500);

double seconds(Clock::duration d) {
  return std::chrono::duration<double>(d).count();
}

// Tells the keeper how long the steps took, except while seeking.
void keep_worked(SessionEntry& e, double seconds) {
  if (e.keeper && seconds > 0 && !e.jobs.seeking()) e.keeper->worked(seconds);
}

void finish(Job& job, Job::End how) {
  job.end = how;
  if (job.after) job.after(job);
  job.done.notify();
}

// Before the first step there is only the estimate; after a surprise, no figure is trusted.
bool slow(const SessionEntry& e) {
  if (e.jobs.wary || e.session.computing_aside()) return true;
  const double known = e.session.step_seconds();
  return (known > 0 ? known : e.estimated_step) > kSlowStep;
}

}  // namespace

Runner::LaneKind Runner::lane_of(const SessionEntry& entry) {
  if (slow(entry)) return LaneKind::slow;
  if (!entry.jobs.calls.empty()) return LaneKind::express;
  if (entry.jobs.runs.empty()) return LaneKind::playing;
  return entry.jobs.runs.front()->used < kShortRequest ? LaneKind::express : LaneKind::playing;
}

void Runner::schedule(const EntryPtr& entry) {
  JobQueue& jobs = entry->jobs;
  if (jobs.scheduled) return;
  const LaneKind kind = lane_of(*entry);
  jobs.scheduled = lane(kind).add(jobs.used, [this, entry, kind] { turn(entry, kind); });
}

/// Marks a slice in which steps are computed under the entry's lock, for the watchdog.
class Runner::UnderWatch {
 public:
  UnderWatch(Runner& runner, const EntryPtr& entry) {
    for (InPlace& place : runner.in_place_) {
      const std::unique_lock lock(place.mutex, std::try_to_lock);
      if (!lock.owns_lock() || place.entry) continue;
      place.entry = entry;
      place_ = &place;
      begin(Clock::now());
      break;
    }
    if (!runner.watching_.exchange(true)) runner.watch();
  }
  ~UnderWatch() {
    if (!place_) return;
    const std::lock_guard lock(place_->mutex);
    place_->entry.reset();
  }
  UnderWatch(const UnderWatch&) = delete;
  UnderWatch& operator=(const UnderWatch&) = delete;
  /// A step begins.
  void begin(Clock::time_point now) {
    if (place_) place_->since.store(now.time_since_epoch().count(), std::memory_order_relaxed);
  }

 private:
  InPlace* place_ = nullptr;
};

void Runner::watch() {
  pool_.call_at(Clock::now() + kWatch, [this](const TimerPtr&) {
    if (stopping_) return;
    const auto now = Clock::now();
    bool any = false;
    for (InPlace& place : in_place_) {
      const std::lock_guard lock(place.mutex);
      if (!place.entry) continue;
      any = true;
      const Clock::time_point since{Clock::duration(place.since.load(std::memory_order_relaxed))};
      if (now - since > kWatch) place.entry->interrupt.raise();
    }
    if (any) {
      watch();
    } else {
      watching_ = false;
    }
  });
}

void Runner::carry_out_calls(SessionEntry& entry) {
  while (!entry.jobs.calls.empty()) {
    const JobPtr job = entry.jobs.calls.front();
    entry.jobs.calls.pop_front();
    Job::End end = job->cancelled ? Job::End::cancelled : Job::End::reached;
    if (end == Job::End::reached) {
      try {
        job->call(entry);
      } catch (...) {
        job->error = std::current_exception();
        end = Job::End::threw;
      }
    }
    finish(*job, end);
    entry.publish();
  }
}

void Runner::cancel_jobs(SessionEntry& entry) {
  for (auto* list : {&entry.jobs.calls, &entry.jobs.runs}) {
    for (const JobPtr& job : *list) {
      finish(*job, Job::End::cancelled);
    }
    list->clear();
  }
}

// What to do next, after ending every job that has nothing left to do.
Runner::Next Runner::next_of(SessionEntry& entry) {
  Session& session = entry.session;
  JobQueue& jobs = entry.jobs;
  while (!jobs.runs.empty()) {
    const JobPtr job = jobs.runs.front();
    const bool seek = job->kind == Job::Kind::seek;
    Job::End end = Job::End::none;
    try {
      if (job->cancelled) {
        end = Job::End::cancelled;
      } else {
        if (!job->begun && (seek || !session.failure())) job->target = job->aim(entry);
        if (!job->begun && seek) session.begin_seek(job->target);
        job->begun = true;
        if (session.failure()) {
          end = Job::End::failed;
        } else if (session.step_index() >= job->target) {
          if (job->reached) job->reached(entry);
          end = Job::End::reached;
        }
      }
    } catch (...) {
      job->error = std::current_exception();
      end = Job::End::threw;
    }
    if (end == Job::End::none) return seek ? Next::silent_step : Next::step;
    if (seek && job->begun) {
      session.end_seek();
    } else if (!session.playing() && job->begun) {
      // Streams with a rate limit have skipped frames; told of the pause, they send the last one.
      session.pause();
    }
    jobs.runs.pop_front();
    // Before anybody is told.
    if (entry.keeper) entry.keeper->stands();
    entry.publish();
    finish(*job, end);
    jobs.clock = Clock::now();
  }
  if (!session.playing()) return Next::nothing;
  const auto now = Clock::now();
  // Steps that have been due for long are late like those beyond the scene's bound: the speed that readers
  // see is of now.
  if (jobs.due > 0 && seconds(now - jobs.clock) > kLate) session.skip(std::exchange(jobs.due, 0));
  if (jobs.due == 0) {
    jobs.due = session.accrue(seconds(now - jobs.clock));
    jobs.clock = now;
  }
  return jobs.due > 0 ? Next::step : Next::wait;
}

StepOutcome Runner::one_step(const EntryPtr& entry, std::unique_lock<FairMutex>& lock,
                             Session::Output output) {
  Session& session = entry->session;
  if (!slow(*entry)) {
    const InterruptScope scope(entry->interrupt);
    return session.step_in_place(output);
  }
  session.begin_aside();
  lock.unlock();
  {
    const InterruptScope scope(entry->interrupt);
    session.compute_aside();
  }
  lock.lock();
  entry->jobs.wary = false;
  return session.commit_aside(output);
}

void Runner::turn(const EntryPtr& entry, LaneKind kind) {
  std::unique_lock lock(entry->mutex);
  JobQueue& jobs = entry->jobs;
  const auto begun = Clock::now();
  auto before = begun;
  std::optional<UnderWatch> under_watch;
  if (kind != LaneKind::slow) under_watch.emplace(*this, entry);
  bool moved = false;
  double worked = 0;  // s of aloud steps
  while (true) {
    entry->interrupt.clear();
    if (entry->removed || stopping_) {
      cancel_jobs(*entry);
      jobs.scheduled = false;
      entry->publish();
      return;
    }
    carry_out_calls(*entry);
    const Next next = next_of(*entry);
    if (next == Next::nothing || next == Next::wait) {
      jobs.scheduled = false;
      jobs.used += seconds(Clock::now() - begun) * (entry->watched() ? 1 : kUnwatched);
      if (moved) entry->settle(), entry->publish();
      keep_worked(*entry, worked);
      if (next == Next::wait) wait_for_clock(entry);
      return;
    }
    if (lane_of(*entry) != kind) break;
    const bool playing = jobs.runs.empty();
    const JobPtr job = playing ? nullptr : jobs.runs.front();
    StepOutcome outcome;
    try {
      outcome =
          one_step(entry, lock, next == Next::silent_step ? Session::Output::silent : Session::Output::aloud);
    } catch (const std::exception& e) {
      // Out of memory, for example: the step is abandoned and the client that asked for it is told why.
      log_error("session {}: {}", entry->id, e.what());
      entry->session.pause();
      if (job) {
        job->error = std::current_exception();
        std::erase(jobs.runs, job);
        finish(*job, Job::End::threw);
      }
      continue;
    }
    const auto now = Clock::now();
    if (job) job->used += seconds(now - before);
    if (next == Next::step) worked += seconds(now - before);
    before = now;
    if (under_watch) under_watch->begin(now);
    moved = true;
    if (outcome == StepOutcome::done) {
      steps_.fetch_add(1, std::memory_order_relaxed);
      if (playing && jobs.due > 0) --jobs.due;
    } else if (outcome == StepOutcome::interrupted) {
      // Either cancelled, which the next iteration notices, or held the lock longer than the watchdog allows.
      jobs.wary = true;
    } else if (outcome == StepOutcome::failed) {
      jobs.due = 0;
    }
    if (kind == LaneKind::slow || now - begun > kSlice) break;
  }
  jobs.scheduled = false;
  jobs.used += seconds(Clock::now() - begun) * (entry->watched() || !jobs.runs.empty() ? 1 : kUnwatched);
  if (moved) entry->settle(), entry->publish();
  keep_worked(*entry, worked);
  schedule(entry);
}

// The next step is due when the accumulator is full again.
void Runner::wait_for_clock(const EntryPtr& entry) {
  const Session& session = entry->session;
  const double wait = (1 - session.alpha()) * session.world().dt() / session.speed();
  const auto due =
      Clock::now() + std::max<Clock::duration>(std::chrono::duration_cast<Clock::duration>(
                                                   std::chrono::duration<double>(std::min(wait, 1.0))),
                                               kShortestWait);
  entry->jobs.waiting = pool_.call_at(due, [this, entry](const TimerPtr& timer) {
    if (stopping_) return;
    const std::lock_guard lock(entry->mutex);
    if (entry->jobs.waiting != timer) return;
    entry->jobs.waiting.reset();
    schedule(entry);
  });
}

}  // namespace truestep