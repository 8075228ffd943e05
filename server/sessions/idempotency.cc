#include "server/sessions/idempotency.h"

#include "engine/base/errors.h"

namespace truestep {

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
  order_.push_back(key);
  while (order_.size() > capacity_) {
    slots_.erase(order_.front());
    order_.pop_front();
  }
  return std::nullopt;
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
  std::erase(order_, key);
}

}  // namespace truestep
