// Commands of a session: the queue for other threads, the journal, and how it is kept short.
#include <algorithm>

#include "engine/base/errors.h"
#include "engine/session/session.h"

namespace truestep {

uint64_t Session::post(Command command) {
  const std::lock_guard lock(queue_mutex_);
  const uint64_t sequence = next_sequence_++;
  queue_.emplace_back(sequence, std::move(command));
  queue_waiting_.store(true, std::memory_order_release);
  return sequence;
}

const WorldState& Session::state_for_commands() {
  drain_queue();
  replay_commands();
  return state_;
}

uint64_t Session::command(const Command& command) {
  state_for_commands();
  const uint64_t sequence = next_sequence_++;
  mark_journal();
  const JournalEntry entry{state_.step, sequence, command};
  for (const auto& sink : sinks_) sink->before_command(entry);
  try {
    world_->apply(state_, command);
  } catch (...) {
    // Nothing has happened: the future that a seek went back from stays.
    for (const auto& sink : sinks_) sink->command_refused(entry);
    throw;
  }
  // A new command makes a new future: entries journalled for later steps no longer hold.
  journal_.resize(journal_cursor_);
  journal_.push_back(entry);
  changed();
  journal_cursor_ = journal_.size();
  // The snapshot of this very step stays: it was taken before the step's commands.
  history_.truncate(state_.step);
  series_.truncate(state_.step);
  if (journal_.size() > options_.journal_entries) shorten_journal();
  return sequence;
}

// Divides a long run of commands by snapshots; otherwise the journal could only be cut at the present. Like
// all snapshots, they are taken before a step's first command.
void Session::mark_journal() {
  const auto done = journal_done();
  if (!done.empty() && done.back().step >= state_.step) return;
  const WorldState* s = history_.at_or_before(state_.step);
  const uint64_t marked = s ? s->step : first_step();
  const auto since = std::lower_bound(done.begin(), done.end(), marked,
                                      [](const JournalEntry& e, uint64_t step) { return e.step < step; });
  if (static_cast<size_t>(done.end() - since) >= options_.journal_entries / 8) history_.keep(state_);
}

// Drops the older half of the journal, up to a snapshot of about that time; if there is none, all of it: the
// past then begins at the present state. All entries have been carried out.
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

}  // namespace truestep
