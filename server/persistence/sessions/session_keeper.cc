#include "server/persistence/sessions/session_keeper.h"

#include "engine/base/log.h"
#include "engine/base/thread_clock.h"
#include "engine/session/snapshot/snapshot.h"
#include "server/persistence/files.h"

namespace truestep {

namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr double kShare = 0.025;        // share of the computing time that saving states may take
constexpr double kLeastPlaying = 1;     // s of computing time between two states, at least
constexpr double kLeastPaused = 0.1;    // ... when the session stops
constexpr double kLittle = 0.01;        // s of steps that are cheaper to repeat than to save at the end
constexpr uint64_t kMostLog = 4 << 20;  // bytes after which a state replaces the log
constexpr auto kTellEvery = std::chrono::milliseconds(100);
constexpr auto kTryEvery = std::chrono::seconds(1);

}  // namespace

struct SessionKeeper::Shared {
  std::mutex mutex;
  bool beside = false;  ///< a state is being written from a copy
  double seconds = 0;   ///< CPU s that the last one took
  std::atomic<bool> written{true};
};

SessionKeeper::SessionKeeper(SessionFolder folder, const Session& session, Beginning beginning,
                             const KeepingMeans& means)
    : session_(session),
      means_(means),
      files_(std::make_shared<StateFiles>(std::move(folder), std::move(beginning.states))),
      number_(beginning.next_number),
      base_step_(beginning.base_step),
      shared_(std::make_shared<Shared>()) {
  begin_log(LogRecord::Kind::continues);
}

// --- what happens to the session

void SessionKeeper::notify(std::string_view kind, uint64_t step, const std::string&) {
  if (kind == "reset") {
    save_anew();
  } else if (kind == "seek") {
    // Logs only lead forward.
    if (step < base_step_)
      save_anew();
    else
      stands();
  } else if (kind == "playback" && !session_.playing()) {
    stands();
    if (due_to_save(kLeastPaused)) save_beside();
  }
}

void SessionKeeper::before_command(const JournalEntry& entry) {
  // What cannot be kept is not carried out: a restart would come back without it.
  if (!write({LogRecord::Kind::command, entry.step, entry.sequence, command_text(entry.command)}))
    throw Error(problem_code_, "the command cannot be kept: " + problem_);
  told_step_ = entry.step;
}

void SessionKeeper::command_refused(const JournalEntry& entry) {
  write({LogRecord::Kind::refused, entry.step, entry.sequence, ""});
}

void SessionKeeper::stands() {
  const uint64_t step = session_.step_index();
  if (told_step_ == step && problem_.empty()) return;
  if (write({LogRecord::Kind::stands, step, 0, ""})) told_step_ = step;
}

bool SessionKeeper::acknowledged() const {
  const uint64_t step = session_.step_index();
  return told_step_ == step || step < base_step_ || !problem_.empty();
}

void SessionKeeper::acknowledge() {
  if (!acknowledged()) stands();
}

void SessionKeeper::worked(double seconds) {
  worked_ += seconds;
  const auto now = SteadyClock::now();
  if (now - told_at_ > kTellEvery) {
    told_at_ = now;
    stands();
  }
  if (due_to_save(kLeastPlaying)) save_beside();
}

// --- the log

void SessionKeeper::begin_log(LogRecord::Kind first) {
  first_ = first;
  log_.emplace(folder().log_place(number_), means_.files);
  told_step_ = base_step_;
}

bool SessionKeeper::write(const LogRecord& record) {
  if (!problem_.empty()) {
    // What was missed cannot be written later, but a state contains it all.
    if (SteadyClock::now() - tried_at_ > kTryEvery && record.kind != LogRecord::Kind::refused) save_anew();
    if (!problem_.empty() || record.kind != LogRecord::Kind::command) return problem_.empty();
  }
  try {
    if (log_->bytes() == 0) files_->append(*log_, {first_, session_.step_index(), 0, ""});
    files_->append(*log_, record);
    shared_->written.store(true, std::memory_order_relaxed);
    return true;
  } catch (const Error& e) {
    lose(e);
    return false;
  }
}

void SessionKeeper::lose(const Error& e) {
  if (problem_.empty()) log_warn("session {} is not kept: {}", folder().place().name(), e.what());
  problem_ = e.what(), problem_code_ = e.code();
  tried_at_ = SteadyClock::now();
}

// --- states

SavedState SessionKeeper::saved(Bytes snapshot) const {
  SavedState state{std::move(snapshot), {}, session_.last_sequence()};
  const auto ahead = session_.journal_ahead();
  state.ahead.assign(ahead.begin(), ahead.end());
  return state;
}

StateFiles::Recorded SessionKeeper::recorded() const {
  return [recording = recording_]() -> std::optional<uint64_t> {
    const auto sink = recording.lock();
    if (!sink || sink->status().state != RecordingState::kRecording) return std::nullopt;
    return sink->durable_step().value_or(0);
  };
}

double SessionKeeper::seconds_to_write() const {
  const std::lock_guard lock(shared_->mutex);
  if (shared_->seconds > 0) return shared_->seconds;
  return 2e-4 + 4e-9 * static_cast<double>(session_.state().memory_bytes());
}

bool SessionKeeper::due_to_save(double least_seconds) const {
  if (!problem_.empty()) return false;
  const bool long_log = log_->bytes() > kMostLog;
  if (session_.step_index() == base_step_ && !long_log) return false;
  if (worked_ < least_seconds && !long_log) return false;
  return worked_ >= seconds_to_write() / kShare || long_log;
}

void SessionKeeper::save_beside() {
  {
    const std::lock_guard lock(shared_->mutex);
    if (shared_->beside) return;
  }
  std::shared_ptr<MemoryBudget::Lease> lease;
  try {
    // The copy, its bytes, and those of the file.
    lease = std::make_shared<MemoryBudget::Lease>(
        means_.memory.lease(4 * static_cast<double>(session_.state().memory_bytes()), "saving the session"));
  } catch (const Error&) {
    worked_ = 0;
    return;
  }
  const double begun = thread_cpu_seconds();
  // Until the state is written, the log before it is all that leads here.
  stands();
  ++number_;
  base_step_ = session_.step_index();
  worked_ = 0;
  begin_log(LogRecord::Kind::continues);
  auto state = std::make_shared<std::pair<WorldState, SavedState>>(session_.state(), saved({}));
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->beside = true;
  }
  const std::shared_ptr<const World> world = session_.shared_world();
  const double copied = thread_cpu_seconds() - begun;
  means_.writer.post([shared = shared_, files = files_, world, state, lease, copied, number = number_,
                      step = base_step_, recorded = recorded()] {
    const double begun = thread_cpu_seconds();
    try {
      state->second.snapshot = write_snapshot(*world, state->first);
      files->write(number, step, state->second);
      files->settle(number, step, recorded);
    } catch (const Error& e) {
      // The logs lead here from the previous state.
      log_warn("session {}: {}", files->folder().place().name(), e.what());
    }
    shared->written.store(true, std::memory_order_relaxed);
    const std::lock_guard lock(shared->mutex);
    shared->beside = false;
    shared->seconds = copied + thread_cpu_seconds() - begun;
  });
}

void SessionKeeper::save_anew() {
  tried_at_ = SteadyClock::now();
  const uint64_t number = number_ + 1, step = session_.step_index();
  try {
    const bool start = step == 0 && !session_.origin() && session_.journal_done().empty();
    files_->write(number, step, saved(start ? Bytes() : write_snapshot(session_.world(), session_.state())));
    number_ = number;
    base_step_ = step;
    worked_ = 0;
    begin_log(LogRecord::Kind::anew);
    files_->append(*log_, {LogRecord::Kind::anew, step, 0, ""});
    files_->begin_anew(number);
    problem_.clear();
    shared_->written.store(true, std::memory_order_relaxed);
  } catch (const Error& e) {
    return lose(e);
  }
  means_.writer.post([files = files_, number, step, recorded = recorded()] {
    try {
      files->settle(number, step, recorded);
    } catch (const Error& e) {
      log_warn("session {}: {}", files->folder().place().name(), e.what());
    }
  });
}

void SessionKeeper::save() {
  if (!problem_.empty()) return save_anew();
  stands();
  if (session_.step_index() == base_step_ || worked_ < kLittle) return;
  try {
    files_->write(number_ + 1, session_.step_index(),
                  saved(write_snapshot(session_.world(), session_.state())));
    ++number_;
    base_step_ = session_.step_index();
    worked_ = 0;
    begin_log(LogRecord::Kind::continues);
    shared_->written.store(true, std::memory_order_relaxed);
  } catch (const Error& e) {
    log_warn("session {}: {}", folder().place().name(), e.what());
  }
}

bool SessionKeeper::take_written() {
  return shared_->written.exchange(false);
}

}  // namespace truestep
