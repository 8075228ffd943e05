#include "server/persistence/sessions/saved_session.h"

#include <algorithm>

#include "engine/base/errors.h"
#include "engine/base/log.h"
#include "server/persistence/files.h"

namespace truestep {

namespace {

constexpr size_t kMostLogBytes = size_t{1} << 32, kMostState = size_t{1} << 40;

struct Log {
  uint64_t number = 0;
  LogContents contents;
  bool anew() const {
    return !contents.records.empty() && contents.records.front().kind == LogRecord::Kind::anew;
  }
};

std::vector<Log> read_logs(const SessionFolder& folder, const std::vector<uint64_t>& numbers) {
  std::vector<Log> logs;
  for (const uint64_t n : numbers)
    logs.push_back({n, read_records(read_file(folder.log_place(n), kMostLogBytes))});
  return logs;
}

/// States to try, best first. Number 0 is the start of the scene, which needs no file.
struct Candidate {
  uint64_t number = 0, step = 0;
};

std::vector<Candidate> candidates(const SessionFolder::Contents& there, std::span<const Log> logs,
                                  std::optional<uint64_t> recorded) {
  uint64_t barrier = 0;
  for (const Log& log : logs) {
    if (log.anew() && there.states.contains(log.number)) barrier = log.number;
  }
  std::vector<Candidate> fit, late, before;
  for (auto it = there.states.rbegin(); it != there.states.rend(); ++it) {
    const Candidate c{it->first, it->second};
    (c.number < barrier ? before : recorded && c.step > *recorded ? late : fit).push_back(c);
  }
  const bool from_start = there.states.empty() || (!logs.empty() && logs.front().number == 0);
  if (from_start) (barrier > 0 ? before : fit).push_back({});
  // States that begin too late for the recording: the earlier, the smaller the gap.
  fit.insert(fit.end(), late.rbegin(), late.rend());
  fit.insert(fit.end(), before.begin(), before.end());
  return fit;
}

}  // namespace

LoggedCourse follow(const SavedState& state, uint64_t from, std::span<const LogRecord> records) {
  const auto contradiction = [] {
    return Error("session_damaged", "the records of the session's journal contradict each other");
  };
  LoggedCourse c{state.ahead, std::nullopt, from, from, state.last_sequence};
  for (const JournalEntry& e : c.journal) {
    if (e.step < from) throw contradiction();
  }
  // A command that was carried out discards the recorded future; what follows it in the log confirms it.
  const auto confirm = [&] {
    if (!c.unconfirmed) return;
    std::erase_if(c.journal, [&](const JournalEntry& e) { return e.step > c.unconfirmed->step; });
    c.journal.push_back(std::move(*c.unconfirmed));
    c.unconfirmed.reset();
  };
  for (const LogRecord& r : records) {
    if (r.kind == LogRecord::Kind::refused) {
      if (!c.unconfirmed || c.unconfirmed->sequence != r.sequence) throw contradiction();
      c.unconfirmed.reset();
    }
    confirm();
    if (r.kind == LogRecord::Kind::continues || r.kind == LogRecord::Kind::anew) continue;
    if (r.step < from || r.step > kMostStep) throw contradiction();
    if (r.kind == LogRecord::Kind::command) {
      c.unconfirmed = {r.step, r.sequence, command_of(r.text)};
      c.last_sequence = std::max(c.last_sequence, r.sequence);
    }
    c.step = r.step;
    c.furthest = std::max(c.furthest, r.step);
  }
  return c;
}

SavedSession read_saved_session(const SessionFolder& folder, std::optional<uint64_t> recorded) {
  SavedSession out;
  out.about = folder.about();
  out.scene = folder.scene();
  const SessionFolder::Contents there = folder.contents();
  const std::vector<Log> logs = read_logs(folder, there.logs);
  if (!there.states.empty()) out.next_number = there.states.rbegin()->first + 1;
  if (!logs.empty()) out.next_number = std::max(out.next_number, logs.back().number + 1);
  std::string why = "no usable state is left";
  for (const Candidate& c : candidates(there, logs, recorded)) {
    try {
      SavedState state;
      if (c.number > 0) state = read_saved_state(read_file(folder.state_place(c.number, c.step), kMostState));
      std::vector<LogRecord> records;
      bool complete = true;
      for (const Log& log : logs) {
        if (log.number < c.number) continue;
        // Nothing leads on past this log: its state would have been the next to try.
        if (log.anew() && log.number > c.number) complete = false;
        if (!complete) break;
        records.insert(records.end(), log.contents.records.begin(), log.contents.records.end());
        if (log.contents.end == LogContents::End::damaged) complete = false;
      }
      out.course = follow(state, c.step, records);
      out.snapshot = std::move(state.snapshot);
      out.from_step = c.step;
      out.complete = complete;
      return out;
    } catch (const Error& e) {
      log_error("session {}: state {} cannot be used: {}", out.about.id, c.number, e.what());
      why = e.what();
    }
  }
  throw Error("session_damaged", "what is saved of this session cannot be used: " + why);
}

}  // namespace truestep
