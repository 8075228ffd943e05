#include "server/sessions/runner.h"

#include <algorithm>

#include "engine/base/log.h"

namespace truestep {

namespace {

constexpr int kPlayingNice = 4, kSlowNice = 10, kPictureNice = 5;

}  // namespace

Runner::Runner(int workers, std::optional<std::chrono::milliseconds> grace)
    : pool_(std::max(2, workers)),
      picture_thread_(1),
      grace_(grace),
      express_(std::max(2, workers), 0),
      playing_(workers, kPlayingNice),
      slow_(workers, kSlowNice) {
  picture_thread_.post([] { yield_to_others(kPictureNice); });
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

Task<JobPtr> Runner::end_of(EntryPtr entry, JobPtr job) {
  const auto ended = [job] { return job->end != Job::End::none; };
  const auto give_up = [entry, job] {
    job->cancelled = true;
    const std::lock_guard lock(entry->mutex);
    const auto& runs = entry->jobs.runs;
    if (!runs.empty() && runs.front() == job) entry->interrupt.raise();
  };
  co_await wait_for_end(job->done, ended, give_up);
  if (job->end == Job::End::threw) entry->use([&job](SessionEntry&) { std::rethrow_exception(job->error); });
  co_return job;
}

Task<JobPtr> Runner::run_to(EntryPtr entry, Job::Kind kind, Aim aim,
                            std::function<void(SessionEntry&)> reached) {
  JobPtr job = Job::run(kind, std::move(aim));
  job->reached = std::move(reached);
  return end_of(entry, start(entry, std::move(job)));
}

Task<JobPtr> Runner::call(EntryPtr entry, std::function<void(SessionEntry&)> f) {
  return end_of(entry, start(entry, Job::between_steps(std::move(f))));
}

namespace {

struct LongWork {
  std::shared_ptr<Interrupt> interrupt = std::make_shared<Interrupt>();
  Signal done;
  std::atomic<bool> ended{false}, late{false};
  std::exception_ptr error;
};

}  // namespace

Task<> Runner::work_elsewhere(std::function<void()> f, Threads threads,
                              std::optional<std::chrono::seconds> within) {
  const auto work = std::make_shared<LongWork>();
  {
    const std::lock_guard lock(long_mutex_);
    std::erase_if(long_interrupts_, [](const auto& w) { return w.expired(); });
    long_interrupts_.push_back(work->interrupt);
    if (stopping_) work->interrupt->raise();
  }
  const std::function<void()> run = [this, work, &f, within] {
    TimerPtr end;
    if (within) {
      end = pool_.call_at(Clock::now() + *within, [work](const TimerPtr&) {
        work->late = true;
        work->interrupt->raise();
      });
    }
    try {
      const InterruptScope scope(*work->interrupt);
      interruption_point();
      f();
    } catch (...) {
      work->error = std::current_exception();
    }
    if (end) end->cancel();
    work->ended = true;
    work->done.notify();
  };
  if (threads == Threads::long_work) {
    start_long_work(run);
  } else {
    picture_thread_.post([this, run] {
      run();
      --pictures_;
    });
  }
  const auto ended = [work] { return work->ended.load(); };
  const auto give_up = [work] { work->interrupt->raise(); };
  co_await wait_for_end(work->done, ended, give_up);
  if (work->error && work->late)
    throw Error("too_large", "the request takes more than " + std::to_string(within->count()) + " s to read");
  if (work->error) std::rethrow_exception(work->error);
}

Task<net::Response> Runner::draw(std::function<net::Response()> f) {
  if (pictures_.fetch_add(1) >= kMostPictures) {
    --pictures_;
    throw Error("quota_exceeded", "too many pictures are being drawn; try again");
  }
  net::Response response;
  co_await work_elsewhere([&] { response = f(); }, Threads::pictures);
  co_return response;
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
  if (entry->jobs.leaving) entry->jobs.leaving->cancel();
  entry->jobs.leaving = pool_.call_at(Clock::now() + *grace_, [this, entry](const TimerPtr& timer) {
    if (stopping_) return;
    const std::lock_guard lock(entry->mutex);
    if (entry->jobs.leaving != timer) return;
    entry->jobs.leaving.reset();
    if (entry->streams > 0 || entry->keep_running || !entry->session.playing()) return;
    if (entry->watched()) return left_alone(entry);
    log_info("session {}: paused, no viewers", entry->id);
    entry->session.pause();
    entry->jobs.due = 0;
    entry->paused_unwatched = true;
    entry->publish();
  });
}

}  // namespace truestep
