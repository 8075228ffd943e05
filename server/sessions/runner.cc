#include "server/sessions/runner.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "engine/base/log.h"
#include "server/persistence/session_keeper.h"

namespace truestep {

namespace asio = boost::asio;

namespace {

constexpr auto kSlice = std::chrono::milliseconds(5);
constexpr double kSlowStep = 0.01;      // s; such steps are computed beside the state that readers see
constexpr double kShortRequest = 0.02;  // s of computing, beyond which a request is no small one
constexpr double kUnwatched = 8;        // times what a second counts when nobody looks
constexpr auto kWatch = std::chrono::milliseconds(15);
constexpr auto kShortestWait = std::chrono::microseconds(500);
constexpr int kPlayingNice = 4, kSlowNice = 10, kPictureNice = 5;

double seconds(Clock::duration d) {
  return std::chrono::duration<double>(d).count();
}

// What steps that were no part of a seek have come to is kept now and then.
void keep_worked(SessionEntry& e, double seconds) {
  const bool seeking =
      !e.jobs.runs.empty() && e.jobs.runs.front()->kind == Job::Kind::seek && e.jobs.runs.front()->begun;
  if (e.keeper && seconds > 0 && !seeking) e.keeper->worked(seconds);
}

bool watched(const SessionEntry& e) {
  return e.streams > 0 || (e.poll && !e.poll->expired());
}

void finish(Job& job, Job::End how) {
  job.end = how;
  if (job.after) job.after(job);
  job.done.notify();
}

// Nothing tells the length of a first step but the estimate, and after a surprise nothing does.
bool slow(const SessionEntry& e) {
  if (e.jobs.wary || e.session.computing_aside()) return true;
  const double known = e.session.step_seconds();
  return (known > 0 ? known : e.estimated_step) > kSlowStep;
}

}  // namespace

Runner::Runner(int workers, std::optional<std::chrono::milliseconds> grace)
    : pool_(static_cast<size_t>(std::max(2, workers))),
      picture_thread_(1),
      grace_(grace),
      express_(std::max(2, workers), 0),
      playing_(workers, kPlayingNice),
      slow_(workers, kSlowNice) {
  asio::post(picture_thread_, [] { yield_to_others(kPictureNice); });
}

Runner::~Runner() {
  join();
}

// --- the end

void Runner::cancel_all(const std::vector<EntryPtr>& entries) {
  stopping_ = true;
  {
    const std::lock_guard lock(long_mutex_);
    for (const auto& w : long_interrupts_) {
      if (const auto interrupt = w.lock()) interrupt->raise();
    }
  }
  for (const EntryPtr& e : entries) {
    e->interrupt.raise();
    const std::lock_guard lock(e->mutex);
    e->session.pause();
    interrupt(*e);
    if (e->jobs.waiting) e->jobs.waiting->cancel();
    if (e->jobs.leaving) e->jobs.leaving->cancel();
    cancel_jobs(*e);
  }
}

void Runner::join() {
  stopping_ = true;
  express_.stop();
  playing_.stop();
  slow_.stop();
  pool_.join();
  picture_thread_.join();
}

// --- what is asked for

JobPtr Runner::start(const EntryPtr& entry, JobPtr job) {
  const std::lock_guard lock(entry->mutex);
  queue(entry, job);
  return job;
}

void Runner::queue(const EntryPtr& entry, const JobPtr& job) {
  (job->kind == Job::Kind::call ? entry->jobs.calls : entry->jobs.runs).push_back(job);
  if (stopping_) {
    cancel_jobs(*entry);
  } else {
    schedule(entry);
  }
}

asio::awaitable<JobPtr> Runner::end_of(EntryPtr entry, JobPtr job) {
  const auto ended = [job] { return job->end != Job::End::none; };
  const auto give_up = [entry, job] {
    job->cancelled = true;
    const std::lock_guard lock(entry->mutex);
    const auto& runs = entry->jobs.runs;
    if (!runs.empty() && runs.front() == job) entry->interrupt.raise();
  };
  co_await net::wait_for_end(job->done, ended, give_up);
  if (job->end == Job::End::threw) std::rethrow_exception(job->error);
  co_return job;
}

asio::awaitable<JobPtr> Runner::run_to(EntryPtr entry, Job::Kind kind, Aim aim) {
  return end_of(entry, start(entry, Job::run(kind, std::move(aim))));
}

asio::awaitable<JobPtr> Runner::call(EntryPtr entry, std::function<void(SessionEntry&)> f) {
  return end_of(entry, start(entry, Job::between_steps(std::move(f))));
}

void Runner::start_long_work(const std::function<void()>& f) {
  double used = 0;
  // At the end of the service it runs into its interrupt.
  if (!slow_.add(used, f)) f();
}

void Runner::interrupt(SessionEntry& entry) {
  for (const JobPtr& job : entry.jobs.runs) job->cancelled = true;
  entry.jobs.due = 0;
  if (entry.jobs.scheduled) entry.interrupt.raise();
}

void Runner::keep_playing(const EntryPtr& entry) {
  if (entry->jobs.scheduled) return;
  entry->jobs.clock = Clock::now();
  schedule(entry);
}

// Whoever polls frames looks as well, and whoever plays a session that no stream is open to knows that.
void Runner::left_alone(const EntryPtr& entry) {
  if (!grace_ || stopping_ || entry->removed || entry->keep_running || !entry->session.playing()) return;
  const auto timer = std::make_shared<asio::steady_timer>(pool_);
  timer->expires_after(*grace_);
  if (entry->jobs.leaving) entry->jobs.leaving->cancel();
  entry->jobs.leaving = timer;
  timer->async_wait([this, entry, timer](const boost::system::error_code& e) {
    if (e || stopping_) return;
    const std::lock_guard lock(entry->mutex);
    if (entry->jobs.leaving != timer) return;
    entry->jobs.leaving.reset();
    if (entry->streams > 0 || entry->keep_running || !entry->session.playing()) return;
    if (watched(*entry)) return left_alone(entry);
    spdlog::info("session {}: paused, nobody watches", entry->id);
    entry->session.pause();
    entry->jobs.due = 0;
    entry->paused_unwatched = true;
    entry->publish();
  });
}

// --- turns

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

/// Marks a slice in which steps are computed under the entry's lock.
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
  /// The next step begins.
  void begin(Clock::time_point now) {
    if (place_) place_->since.store(now.time_since_epoch().count(), std::memory_order_relaxed);
  }

 private:
  InPlace* place_ = nullptr;
};

void Runner::watch() {
  watch_timer_.expires_after(kWatch);
  watch_timer_.async_wait([this](const boost::system::error_code& e) {
    if (e || stopping_) return;
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

// What comes next, with every job that has nothing left to do ended.
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
      // Streams of a bounded rate left out the steps that came too soon: told of the pause, they send the
      // last.
      session.pause();
    }
    jobs.runs.pop_front();
    // Before anybody hears of it.
    if (entry.keeper) entry.keeper->stands();
    entry.publish();
    finish(*job, end);
    jobs.clock = Clock::now();
  }
  if (!session.playing()) return Next::nothing;
  if (jobs.due == 0) {
    const auto now = Clock::now();
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
  double worked = 0;  // s of steps that readers saw
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
      jobs.used += seconds(Clock::now() - begun) * (watched(*entry) ? 1 : kUnwatched);
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
      // No memory, say: the step is given up, and whoever asked for it hears why.
      spdlog::error("session {}: {}", entry->id, e.what());
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
      // Cancelled, which the next look finds, or longer than the watch allows under a lock.
      jobs.wary = true;
    } else if (outcome == StepOutcome::failed) {
      jobs.due = 0;
    }
    if (kind == LaneKind::slow || now - begun > kSlice) break;
  }
  jobs.scheduled = false;
  jobs.used += seconds(Clock::now() - begun) * (watched(*entry) || !jobs.runs.empty() ? 1 : kUnwatched);
  if (moved) entry->settle(), entry->publish();
  keep_worked(*entry, worked);
  schedule(entry);
}

// The next step is due when the accumulator is full again.
void Runner::wait_for_clock(const EntryPtr& entry) {
  const Session& session = entry->session;
  const double wait = (1 - session.alpha()) * session.world().dt() / session.speed();
  const auto timer = std::make_shared<asio::steady_timer>(pool_);
  timer->expires_after(std::max<Clock::duration>(
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::min(wait, 1.0))),
      kShortestWait));
  entry->jobs.waiting = timer;
  timer->async_wait([this, entry, timer](const boost::system::error_code& e) {
    if (e || stopping_) return;
    const std::lock_guard lock(entry->mutex);
    if (entry->jobs.waiting != timer) return;
    entry->jobs.waiting.reset();
    schedule(entry);
  });
}

}  // namespace truestep
