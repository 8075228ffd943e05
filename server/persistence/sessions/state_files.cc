#include "server/persistence/sessions/state_files.h"

#include <utility>

#include "server/persistence/files.h"

namespace truestep {

StateFiles::StateFiles(SessionFolder folder, std::map<uint64_t, uint64_t> states)
    : folder_(std::move(folder)), states_(std::move(states)) {}

void StateFiles::write(uint64_t number, uint64_t step, const SavedState& state) {
  FreshFile file(folder_.state_place(number, step), write_saved_state(state), Durability::process);
  const std::lock_guard lock(mutex_);
  if (abandoned_) return;
  file.commit();
  states_[number] = step;
}

void StateFiles::begin_anew(uint64_t number) {
  const std::lock_guard lock(mutex_);
  first_ = number;
}

void StateFiles::append(RecordLog& log, const LogRecord& record) {
  const std::lock_guard lock(mutex_);
  if (!abandoned_) log.append(record);
}

void StateFiles::settle(uint64_t number, uint64_t step, const Recorded& recorded) {
  {
    const std::lock_guard lock(mutex_);
    if (abandoned_ || !states_.contains(number)) return;
  }
  if (!std::exchange(described_, true)) harden_file(folder_.about_place());
  harden_file(folder_.state_place(number, step));
  const auto limit = recorded ? recorded() : std::nullopt;
  const std::lock_guard lock(mutex_);
  if (abandoned_) return;
  uint64_t needed = first_;
  for (const auto& [n, at] : states_) {
    if (n <= number && (!limit || at <= *limit)) needed = std::max(needed, n);
  }
  if (needed == 0) return;
  std::erase_if(states_, [&](const auto& s) {
    if (s.first < needed) folder_.state_place(s.first, s.second).remove();
    return s.first < needed;
  });
  for (const uint64_t n : folder_.contents().logs) {
    if (n < needed) folder_.log_place(n).remove();
  }
}

void StateFiles::abandon() {
  const std::lock_guard lock(mutex_);
  abandoned_ = true;
}

}  // namespace truestep
