// Steps of a session: in place, or computed beside the state that readers see; and diagnosis when a step
// fails.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

#include "engine/base/interrupt.h"
#include "engine/session/remedies.h"
#include "engine/session/session.h"

namespace truestep {

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

StepOutcome Session::step_in_place(Output output) {
  {
    // Commands are not interruptible.
    const InterruptScope undisturbed(nullptr);
    drain_queue();
    replay_commands();
  }
  const uint64_t good = state_.step;
  // A step that a snapshot may follow is timed, to tell the history what it may cost; reading the clock takes
  // as long as a step of the smallest worlds, so not every step is timed.
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
    due_.push_back(sink.get());
    const FrameRequest& r = sink->request();
    wanted.fields.insert(wanted.fields.end(), r.fields.begin(), r.fields.end());
    wanted.extras = wanted.extras | r.extras;
    wanted.wishes = wanted.wishes | r.wishes;
  }
  if (due_.empty()) return;
  std::sort(wanted.fields.begin(), wanted.fields.end());
  wanted.fields.erase(std::unique(wanted.fields.begin(), wanted.fields.end()), wanted.fields.end());
  const FramePtr built = frame(wanted);
  for (Sink* sink : due_) sink->accept(built);
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
    // Remedies are tried from some steps before the last good one.
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
    // An interrupted search gives no remedies; the failure stands.
  }
  for (size_t i = 0; i < f.remedies.size(); ++i) f.detail += (i ? ", or " : "; try ") + f.remedies[i];
  return f;
}

void Session::fail(Failure failure) {
  failure_ = std::move(failure);
  playing_ = false;
  notify("instability", failure_->detail);
}

}  // namespace truestep
