#include "server/sessions/memory_budget.h"

#include <cmath>
#include <utility>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"

namespace truestep {

MemoryBudget::Lease::Lease(Lease&& other) noexcept
    : budget_(std::exchange(other.budget_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}

MemoryBudget::Lease& MemoryBudget::Lease::operator=(Lease&& other) noexcept {
  std::swap(budget_, other.budget_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

MemoryBudget::Lease::~Lease() {
  if (budget_) budget_->take(-bytes_);
}

// Whole bytes: their sums are exact, so everything taken is given back to the last byte.
bool MemoryBudget::Lease::resize(double bytes) {
  bytes = std::ceil(bytes);
  if (!budget_ || !budget_->take(bytes - bytes_)) return !budget_;
  bytes_ = bytes;
  return true;
}

void MemoryBudget::Lease::require(double bytes, const std::string& what) {
  if (!resize(bytes)) budget_->refuse(bytes, what);
}

void MemoryBudget::Lease::count(double bytes) {
  if (!budget_) return;
  bytes = std::ceil(bytes);
  {
    const std::lock_guard lock(budget_->mutex_);
    budget_->used_ += bytes - bytes_;
  }
  bytes_ = bytes;
}

bool MemoryBudget::take(double more) {
  const std::lock_guard lock(mutex_);
  // Written so that NaN is refused.
  if (more > 0 && !(used_ + more <= limit_)) return false;
  used_ += more;
  return true;
}

double MemoryBudget::used() const {
  const std::lock_guard lock(mutex_);
  return used_;
}

MemoryBudget::Lease MemoryBudget::lease(double bytes, const std::string& what) {
  bytes = std::ceil(bytes);
  if (!std::isfinite(bytes) || !take(bytes)) refuse(bytes, what);
  return {*this, bytes};
}

void MemoryBudget::refuse(double bytes, const std::string& what) const {
  throw Error("quota_exceeded", what + " needs " + short_number(bytes / 1e6, 3) + " MB, and of the " +
                                    short_number(limit_ / 1e6, 3) + " MB of this server " +
                                    short_number(std::max(0.0, limit_ - used()) / 1e6, 3) + " MB are free");
}

}  // namespace truestep
