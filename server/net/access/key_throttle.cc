#include "server/net/access/key_throttle.h"

#include <algorithm>

namespace truestep::net {

int KeyThrottle::wait(std::string_view remote, std::string_view digest, Clock::time_point now) {
  const std::string network = network_of(remote);
  const std::lock_guard lock(mutex_);
  const auto debt = debts_.find(network);
  if (debt == debts_.end() || debt->second <= now + (kFreeFailures - 1) * kEach) return 0;
  const auto known = known_.find(network + ' ' + std::string(digest));
  if (known != known_.end() && known->second > now) return 0;
  const auto left = debt->second - (now + (kFreeFailures - 1) * kEach);
  return static_cast<int>(std::chrono::ceil<std::chrono::seconds>(left).count());
}

void KeyThrottle::failed(std::string_view remote, Clock::time_point now) {
  std::string network = network_of(remote);
  const std::lock_guard lock(mutex_);
  if (!debts_.contains(network)) make_room(debts_, now);
  Clock::time_point& until = debts_[std::move(network)];
  until = std::max(until, now) + kEach;
}

void KeyThrottle::succeeded(std::string_view remote, std::string_view digest, Clock::time_point now) {
  std::string key = network_of(remote) + ' ' + std::string(digest);
  const std::lock_guard lock(mutex_);
  if (!known_.contains(key)) make_room(known_, now);
  known_[std::move(key)] = now + kRemembered;
}

size_t KeyThrottle::rows() const {
  const std::lock_guard lock(mutex_);
  return debts_.size() + known_.size();
}

// Expired rows go first, then those that expire soonest.
void KeyThrottle::make_room(Rows& rows, Clock::time_point now) {
  if (rows.size() < kMostRows) return;
  std::erase_if(rows, [now](const auto& row) { return row.second <= now; });
  if (rows.size() < kMostRows) return;
  rows.erase(std::min_element(rows.begin(), rows.end(),
                              [](const auto& a, const auto& b) { return a.second < b.second; }));
}

}  // namespace truestep::net
