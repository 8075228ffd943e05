#include "engine/session/session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

#include "engine/base/errors.h"
#include "engine/base/interrupt.h"
#include "engine/session/remedies.h"

namespace truestep {

namespace {

// Energies and probes are always kept. What a scene names is worth every step to it.
Series series_of(const SceneHeader& header) {
  constexpr size_t kUnasked = 2048;
  std::vector<std::string> wanted = header.observables;
  wanted.emplace_back("energy");
  for (const ProbeParams& p : header.probes) wanted.push_back(p.id);
  if (!header.observables.empty()) return Series(std::move(wanted));
  return Series(std::move(wanted), Series::Rate::sparing, kUnasked);
}

}  // namespace

Session::Session(std::shared_ptr<const World> world, std::shared_ptr<const ThreadArena> arena,
                 SessionOptions options)
    : world_(std::move(world)),
      arena_(std::move(arena)),
      options_(options),
      state_(world_->initial_state()),
      frames_(world_),
      history_(options.history_bytes, options.history_room),
      series_(series_of(world_->scene().header)) {
  world_->require_finite_energy(state_);
  record_series();
}

uint64_t Session::step(uint64_t n) {
  if (failure_) throw Error("instability", failure_->detail);
  uint64_t done = 0;
  while (done < n && one_step()) ++done;
  return done;
}

void Session::examine() {
  if (failure_) return;
  collect_warnings(Output::aloud);
  try {
    world_->examine(state_, workspace_, *arena_);
  } catch (const Instability& e) {
    Failure failure = diagnose(e);
    state_ = replayed(failure.last_good_step);
    changed();
    fail(std::move(failure));
  }
}

// The owner who has nobody waiting.
bool Session::one_step() {
  StepOutcome outcome = step_in_place(Output::aloud);
  if (outcome == StepOutcome::unstable) {
    compute_aside();
    outcome = commit_aside(Output::aloud);
  }
  if (outcome == StepOutcome::interrupted) throw Interrupted();
  return outcome == StepOutcome::done;
}

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

// --- steps in parts

StepOutcome Session::step_in_place(Output output) {
  {
    // Commands are carried out as a whole.
    const InterruptScope undisturbed(nullptr);
    drain_queue();
    replay_commands();
  }
  const uint64_t good = state_.step;
  // A step that a snapshot may follow is timed, for the history to know what it may cost; the clock costs as
  // much as a step of the smallest worlds, so not every step is.
  const bool timed = history_.due(good + 1) || step_seconds_ > 1e-4 || step_seconds_ == 0;
  const auto start = timed ? std::chrono::steady_clock::now() : std::chrono::steady_clock::time_point{};
  const auto recover = [&] {
    const InterruptScope undisturbed(nullptr);
    workspace_.clear();
    state_ = replayed(good);
    changed();
  };
  try {
    world_->step(state_, workspace_, *arena_, profiles_);
  } catch (const Instability& e) {
    recover();
    unstable_ = e;
    aside_ = true;
    return StepOutcome::unstable;
  } catch (const Interrupted&) {
    recover();
    return StepOutcome::interrupted;
  }
  changed();
  if (timed) {
    step_seconds_ = seconds_since(start);
    history_.offer(state_, step_seconds_);
  }
  after_step(output);
  return StepOutcome::done;
}

void Session::begin_aside() {
  if (aside_) return;
  drain_queue();
  replay_commands();
  next_profiles_ = profiles_;
  aside_ = true;
}

void Session::compute_aside() {
  const auto start = std::chrono::steady_clock::now();
  try {
    if (!unstable_) {
      next_ = state_;
      try {
        world_->step(next_, workspace_, *arena_, next_profiles_);
      } catch (const Instability& e) {
        unstable_ = e;
      }
    }
    if (unstable_) diagnosis_ = diagnose(*unstable_);
  } catch (...) {
    thrown_ = std::current_exception();
  }
  next_seconds_ = seconds_since(start);
}

StepOutcome Session::commit_aside(Output output) {
  aside_ = false;
  unstable_.reset();
  if (thrown_) {
    workspace_.clear();
    try {
      std::rethrow_exception(std::exchange(thrown_, nullptr));
    } catch (const Interrupted&) {
      return StepOutcome::interrupted;
    }
  }
  if (diagnosis_) {
    fail(std::move(*diagnosis_));
    diagnosis_.reset();
    return StepOutcome::failed;
  }
  std::swap(state_, next_);
  profiles_ = next_profiles_;
  changed();
  step_seconds_ = next_seconds_;
  if (history_.due(state_.step)) history_.offer(state_, step_seconds_);
  after_step(output);
  return StepOutcome::done;
}

void Session::after_step(Output output) {
  const InterruptScope undisturbed(nullptr);
  record_series();
  if (World::watched(state_.step)) collect_warnings(output);
  if (output == Output::silent || sinks_.empty()) return;
  // One frame serves every sink that is due; it holds the union of what they ask for.
  due_.clear();
  FrameRequest wanted;
  for (const auto& sink : sinks_) {
    if (!sink->due(state_.step)) continue;
    due_.push_back(sink);
    const FrameRequest& r = sink->request();
    wanted.fields.insert(wanted.fields.end(), r.fields.begin(), r.fields.end());
    wanted.extras = wanted.extras | r.extras;
    wanted.wishes = wanted.wishes | r.wishes;
  }
  if (due_.empty()) return;
  std::sort(wanted.fields.begin(), wanted.fields.end());
  wanted.fields.erase(std::unique(wanted.fields.begin(), wanted.fields.end()), wanted.fields.end());
  const FramePtr built = frame(wanted);
  for (const auto& sink : due_) sink->accept(built);
}

// --- the clock

void Session::play(double speed) {
  if (!(speed >= kLeastSpeed && speed <= kMostSpeed)) {
    throw Error(
        "bad_request", "speed is a number from 1e-18 to 1e15",
        {{"/speed", "out_of_range", "the value is outside the allowed range", "", "1e-18 to 1e15", "", "1"}});
  }
  if (failure_) throw Error("instability", failure_->detail);
  if (!playing_ || speed != speed_) pace_ = {}, achieved_speed_.reset();
  if (!playing_) accumulator_ = 0;
  playing_ = true;
  speed_ = speed;
  notify("playback", "");
}

void Session::pause() {
  playing_ = false;
  notify("playback", "");
}

uint64_t Session::accrue(double wall_seconds) {
  if (!playing_ || failure_) return 0;
  accumulator_ += std::max(wall_seconds, 0.0) * speed_;
  const double dt = world_->dt();
  const auto owed = static_cast<uint64_t>(std::min(accumulator_ / dt, 1e15));
  // The steps of one sixtieth of a second are never "late", however small dt is.
  const double display = std::ceil(speed_ / (60 * dt));
  const double most = std::max(static_cast<double>(world_->scene().header.time.max_catchup_steps), display);
  const auto bound = static_cast<uint64_t>(std::min(most, 1e15));
  const uint64_t due = std::min(owed, bound);
  // Time beyond the bound is given up, not saved: a late session must not fall further behind.
  skipped_ += owed - due;
  pace_.wall += std::max(wall_seconds, 0.0);
  pace_.wanted += std::max(wall_seconds, 0.0) * speed_;
  pace_.skipped += static_cast<double>(owed - due) * dt;
  if (constexpr double kLook = 0.5; pace_.wall >= kLook) {
    achieved_speed_ = std::max(0.0, pace_.wanted - pace_.skipped) / pace_.wall;
    pace_ = {};
  }
  accumulator_ = std::max(0.0, accumulator_ - static_cast<double>(owed) * dt);
  return due;
}

uint64_t Session::advance(double wall_seconds) {
  const uint64_t due = accrue(wall_seconds);
  uint64_t done = 0;
  while (done < due && one_step()) ++done;
  return done;
}

// --- commands

uint64_t Session::post(Command command) {
  const std::lock_guard lock(queue_mutex_);
  const uint64_t sequence = next_sequence_++;
  queue_.emplace_back(sequence, std::move(command));
  queue_waiting_.store(true, std::memory_order_release);
  return sequence;
}

uint64_t Session::command(const Command& command) {
  drain_queue();
  replay_commands();
  const uint64_t sequence = next_sequence_++;
  // A new command makes a new future: what was journalled for later steps no longer holds.
  journal_.resize(journal_cursor_);
  mark_journal();
  if (journal_.size() >= options_.journal_entries) shorten_journal();
  const JournalEntry entry{state_.step, sequence, command};
  for (const auto& sink : sinks_) sink->before_command(entry);
  try {
    world_->apply(state_, command);
  } catch (...) {
    for (const auto& sink : sinks_) sink->command_refused(entry);
    throw;
  }
  journal_.push_back(entry);
  changed();
  journal_cursor_ = journal_.size();
  // The snapshot of this very step stays: it was taken before the step's commands.
  history_.truncate(state_.step);
  series_.truncate(state_.step);
  return sequence;
}

// A long run of commands is divided by snapshots, or there would be nothing to shorten the journal at but the
// present. They are taken before a step's first command, as all snapshots are.
void Session::mark_journal() {
  if (!journal_.empty() && journal_.back().step >= state_.step) return;
  const WorldState* s = history_.at_or_before(state_.step);
  const uint64_t marked = s ? s->step : first_step();
  const auto since = std::lower_bound(journal_.begin(), journal_.end(), marked,
                                      [](const JournalEntry& e, uint64_t step) { return e.step < step; });
  if (static_cast<size_t>(journal_.end() - since) >= options_.journal_entries / 8) history_.keep(state_);
}

// The older half of the journal goes, up to a snapshot of that time; where there is none near, all of it: the
// past then begins at the present state. `command` is about to add an entry, and all entries are carried out.
void Session::shorten_journal() {
  const WorldState* s = history_.at_or_before(journal_[journal_.size() / 2].step);
  const auto kept = std::find_if(journal_.begin(), journal_.end(),
                                 [&](const JournalEntry& e) { return s && e.step >= s->step; });
  const auto gone = static_cast<size_t>(kept - journal_.begin());
  if (s && s->step > first_step() && gone >= journal_.size() / 4) {
    origin_ = *s;
    journal_.erase(journal_.begin(), kept);
  } else {
    origin_ = state_;
    journal_.clear();
    // Snapshots of this step are older than its commands, which are part of the new origin.
    history_.clear();
  }
  history_.forget_before(first_step());
  journal_cursor_ = journal_.size();
}

void Session::drain_queue() {
  if (!queue_waiting_.load(std::memory_order_acquire)) return;
  std::vector<std::pair<uint64_t, Command>> waiting;
  {
    const std::lock_guard lock(queue_mutex_);
    waiting.swap(queue_);
    queue_waiting_.store(false, std::memory_order_release);
  }
  for (auto& [sequence, command] : waiting) {
    try {
      this->command(command);
    } catch (const Error& e) {
      notify("command_refused", e.what());
    }
  }
}

void Session::replay_commands() {
  for (; journal_cursor_ < journal_.size() && journal_[journal_cursor_].step <= state_.step;
       ++journal_cursor_) {
    world_->apply(state_, journal_[journal_cursor_].command);
    changed();
  }
}

uint64_t Session::hash() const {
  if (!hash_) hash_ = state_.hash();
  return *hash_;
}

// --- the past

void Session::reset() {
  load(world_->initial_state());
  origin_.reset();
  skipped_ = 0;
  notify("reset", "");
}

void Session::restore(WorldState state) {
  world_->require_state(state);
  origin_ = state;
  load(std::move(state));
  notify("reset", "");
}

void Session::resume(std::optional<WorldState> origin, std::vector<JournalEntry> journal) {
  if (origin) world_->require_state(*origin);
  origin_ = std::move(origin);
  load(origin_ ? *origin_ : world_->initial_state());
  uint64_t last = 0;
  for (const JournalEntry& e : journal) last = std::max(last, e.sequence);
  next_sequence_ = last + 1;
  journal_ = std::move(journal);
}

// A failed step whose remedies nobody has looked for yet belongs to a state that is left.
void Session::abandon_aside() {
  aside_ = false;
  unstable_.reset();
}

void Session::load(WorldState state) {
  abandon_aside();
  state_ = std::move(state);
  changed();
  history_.clear();
  series_.clear();
  journal_.clear();
  journal_cursor_ = 0;
  failure_.reset();
  warnings_.clear();
  accumulator_ = 0;
  record_series();
}

WorldState Session::snapshot_at_or_before(uint64_t step) const {
  if (const WorldState* s = history_.at_or_before(step)) return *s;
  return origin_ ? *origin_ : world_->initial_state();
}

void Session::begin_seek(uint64_t step) {
  drain_queue();
  const uint64_t first = first_step();
  if (step < first) {
    throw Error("conflict", "this session's past begins at step " + std::to_string(first));
  }
  if (step >= state_.step && !failure_) return;
  abandon_aside();
  state_ = snapshot_at_or_before(step);
  changed();
  // Snapshots are taken before the commands of their step.
  journal_cursor_ = 0;
  while (journal_cursor_ < journal_.size() && journal_[journal_cursor_].step < state_.step) ++journal_cursor_;
  series_.truncate(state_.step);
  failure_.reset();
  std::erase_if(warnings_, [&](const SessionWarning& w) { return w.first_step > state_.step; });
}

void Session::end_seek() {
  replay_commands();
  accumulator_ = 0;
  notify("seek", "");
}

void Session::seek(uint64_t step) {
  begin_seek(step);
  while (state_.step < step) {
    StepOutcome outcome = step_in_place(Output::silent);
    if (outcome == StepOutcome::unstable) {
      compute_aside();
      outcome = commit_aside(Output::silent);
    }
    if (outcome == StepOutcome::interrupted) throw Interrupted();
    if (outcome == StepOutcome::failed) break;
  }
  end_seek();
}

Failure Session::diagnose(const Instability& e) const {
  Failure f;
  f.system = e.system;
  f.quantity = e.quantity;
  f.index = e.index;
  f.last_good_step = static_cast<uint64_t>(e.step);
  f.step = f.last_good_step + 1;
  f.time = static_cast<double>(f.step) * world_->dt();
  char time[32];
  std::snprintf(time, sizeof time, "%.6g", f.time);
  f.detail = "system \"" + e.system + "\": " + e.what() +
             (e.index >= 0 ? " (row " + std::to_string(e.index) + ")" : "") + " in step " +
             std::to_string(f.step) + " (t = " + time + " s)";
  try {
    // Remedies are tried from some way before the last good step.
    const uint64_t good = f.last_good_step, first = first_step();
    const WorldState before = replayed(good - std::min(good - first, trial_steps_before(*world_)));
    const auto hint = e.suggested_dt > 0 ? std::optional(e.suggested_dt) : world_->stable_dt(state_);
    const Commands again = [this](const World& world, WorldState& state) {
      for (const JournalEntry& entry : journal_) {
        if (entry.step == state.step) world.apply(state, entry.command);
      }
    };
    Remedies remedies = try_remedies(*world_, before, good, f.system, hint, again, *arena_);
    f.suggested_dt = remedies.dt;
    f.remedies = std::move(remedies.sentences);
  } catch (const Interrupted&) {
    // Whoever interrupts wants no remedies; the failure stands.
  }
  for (size_t i = 0; i < f.remedies.size(); ++i) f.detail += (i ? ", or " : "; try ") + f.remedies[i];
  return f;
}

void Session::fail(Failure failure) {
  failure_ = std::move(failure);
  playing_ = false;
  notify("instability", failure_->detail);
}

// --- what comes out

void Session::add_sink(std::shared_ptr<Sink> sink) {
  sinks_.push_back(std::move(sink));
}

void Session::remove_sink(const Sink* sink) {
  std::erase_if(sinks_, [&](const auto& s) { return s.get() == sink; });
}

void Session::collect_warnings(Output output) {
  for (World::SystemWarning& found : world_->warnings(state_)) {
    const std::string& id = world_->id(found.system);
    const auto known = std::ranges::find_if(warnings_, [&](const SessionWarning& w) {
      return w.system == id && w.warning.quantity == found.warning.quantity;
    });
    if (known == warnings_.end()) {
      warnings_.push_back({id, std::move(found.warning), state_.step});
      if (output == Output::aloud)
        notify("warning", "system \"" + id + "\": " + warnings_.back().warning.detail);
    } else if (std::abs(found.warning.value) > std::abs(known->warning.value)) {
      known->warning = std::move(found.warning);
    }
  }
}

void Session::notify(std::string_view kind, const std::string& detail) {
  for (const auto& sink : sinks_) sink->notify(kind, state_.step, detail);
}

FramePtr Session::frame(const FrameRequest& request) const {
  return frames_.build(state_, alpha(), request);
}

WorldState Session::state_at(uint64_t step) const {
  return past(step).compute();
}

Past Session::past(uint64_t step) const {
  if (step > state_.step || step < first_step())
    throw Error("not_found", "this session's past does not hold this step");
  if (step == state_.step) return {world_, arena_, state_, {}, step};
  Past past{world_, arena_, snapshot_at_or_before(step), {}, step};
  for (const JournalEntry& e : journal_) {
    if (e.step >= past.start.step && e.step <= step) past.commands.push_back(e);
  }
  return past;
}

WorldState Past::compute() const {
  WorldState state = start;
  Workspace scratch;
  size_t cursor = 0;
  while (true) {
    // Like the session itself: a step's commands come first, and those of the wanted step count.
    for (; cursor < commands.size() && commands[cursor].step <= state.step; ++cursor) {
      world->apply(state, commands[cursor].command);
    }
    if (state.step == step) return state;
    world->step(state, scratch, *arena, {});
  }
}

// The present step, too, from its snapshot: in-place steps that failed left nothing else of it.
WorldState Session::replayed(uint64_t step) const {
  Past past{world_, arena_, snapshot_at_or_before(step), {}, step};
  for (const JournalEntry& e : journal_) {
    if (e.step >= past.start.step && e.step <= step) past.commands.push_back(e);
  }
  return past.compute();
}

FramePtr Session::frame_at(uint64_t step, const FrameRequest& request) const {
  return step == state_.step ? frame(request) : frames_.build(state_at(step), 0, request);
}

void Session::record_series() {
  if (!series_.due(state_.step)) return;
  const auto begun = std::chrono::steady_clock::now();
  series_.add(state_.step, observe());
  const auto ended = std::chrono::steady_clock::now();
  const auto seconds = [](std::chrono::steady_clock::duration d) {
    return std::chrono::duration<double>(d).count();
  };
  series_.spent(seconds(ended - begun), seconds(begun - observed_));
  observed_ = ended;
}

double Session::most_series_bytes(const World& world) {
  return static_cast<double>(series_of(world.scene().header).most_bytes(world.known_observables()));
}

size_t Session::overhead_bytes() const {
  return sizeof(*this) + history_.memory_bytes() + series_.memory_bytes() +
         (aside_ || next_.systems.empty() ? 0 : next_.memory_bytes()) +
         journal_.capacity() * sizeof(JournalEntry) + (origin_ ? origin_->memory_bytes() : 0);
}

}  // namespace truestep
