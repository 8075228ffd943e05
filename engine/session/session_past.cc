// The past of a session: reset, restore, seek, and earlier states computed beside the present one.
#include <algorithm>
#include <string>
#include <utility>

#include "engine/base/errors.h"
#include "engine/base/interrupt.h"
#include "engine/session/session.h"

namespace truestep {

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

// A failed step whose remedies have not been searched yet belongs to a state that is being left.
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
    throw Error("conflict", "the history of this session begins at step " + std::to_string(first));
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

WorldState Session::state_at(uint64_t step) const {
  return past(step).compute();
}

Past Session::past(uint64_t step) const {
  if (step > state_.step || step < first_step())
    throw Error("not_found", "the history of this session does not hold this step");
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
    // As in the session itself: a step's commands come first, and those of the requested step are included.
    for (; cursor < commands.size() && commands[cursor].step <= state.step; ++cursor) {
      world->apply(state, commands[cursor].command);
    }
    if (state.step == step) return state;
    world->step(state, scratch, *arena, {});
  }
}

// Also the present step, from its snapshot: after a failed in-place step nothing else is left of it.
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

}  // namespace truestep
