#include "server/sessions/runner.h"

#include <algorithm>
#include <boost/asio/post.hpp>

#include "engine/base/log.h"

namespace truestep {

namespace asio = boost::asio;

namespace {

constexpr int kPlayingNice = 4, kSlowNice = 10, kPictureNice = 5;

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

// --- shutdown

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
    // Dropped, not only cancelled: a session may outlive the pool that its timers belong to.
    if (const auto timer = std::exchange(e->jobs.waiting, nullptr)) timer->cancel();
    if (const auto timer = std::exchange(e->jobs.leaving, nullptr)) timer->cancel();
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

// --- requests

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
  // After shutdown it runs here, and its interrupt ends it at once.
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

// A client that polls frames counts as watching; one that plays a session without an open stream knows that
// nobody watches.
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
    if (entry->watched()) return left_alone(entry);
    spdlog::info("session {}: paused, no viewers", entry->id);
    entry->session.pause();
    entry->jobs.due = 0;
    entry->paused_unwatched = true;
    entry->publish();
  });
}

}  // namespace truestep
