#include "server/sessions/idempotency.h"

#include <algorithm>

#include "engine/base/errors.h"

namespace truestep {

namespace {

std::string caller_of(const std::string& key) {
  const size_t end = key.find('\n');
  return end == std::string::npos ? "" : key.substr(0, end);
}

}  // namespace

std::optional<RememberedAnswer> IdempotencyKeys::begin(const std::string& key, uint64_t request_hash) {
  const std::lock_guard lock(mutex_);
  const auto it = slots_.find(key);
  if (it != slots_.end()) {
    if (it->second.answer.request_hash != request_hash) {
      throw Error("idempotency_key_reused", "this Idempotency-Key was used for another request");
    }
    if (it->second.stage == Slot::Stage::running) {
      throw Error("conflict", "the request with this Idempotency-Key is still being answered");
    }
    return it->second.answer;
  }
  slots_[key].answer.request_hash = request_hash;
  order_[caller_of(key)].push_back(key);
  while (slots_.size() > capacity_) make_room();
  return std::nullopt;
}

void IdempotencyKeys::make_room() {
  const auto most = std::max_element(order_.begin(), order_.end(), [](const auto& a, const auto& b) {
    return a.second.size() < b.second.size();
  });
  slots_.erase(most->second.front());
  most->second.pop_front();
  if (most->second.empty()) order_.erase(most);
}

void IdempotencyKeys::remember(const std::string& key, RememberedAnswer answer) {
  const std::lock_guard lock(mutex_);
  const auto it = slots_.find(key);
  if (it == slots_.end()) return;
  it->second.answer = std::move(answer);
  it->second.stage = Slot::Stage::done;
}

void IdempotencyKeys::forget(const std::string& key) {
  const std::lock_guard lock(mutex_);
  slots_.erase(key);
  const auto keys = order_.find(caller_of(key));
  if (keys == order_.end()) return;
  std::erase(keys->second, key);
  if (keys->second.empty()) order_.erase(keys);
}

}  // namespace truestep
