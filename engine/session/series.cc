#include "engine/session/series.h"

#include <algorithm>
#include <limits>

#include "engine/session/snapshot/references.h"

namespace truestep {

Series::Series(std::vector<std::string> wanted, Rate rate, size_t max_points)
    : wanted_(std::move(wanted)), rate_(rate), max_points_(max_points) {}

bool Series::wants(std::string_view name) const {
  for (const std::string& w : wanted_) {
    if (selects(w, name)) return true;
  }
  return false;
}

void Series::add(uint64_t step, const Observables& values) {
  if (steps_.size() >= max_points_) thin_out();
  if (!due(step)) return;
  steps_.push_back(step);
  for (const Observation& o : values.rows()) {
    if (!wants(o.name)) continue;
    size_t k = 0;
    while (k < names_.size() && names_[k] != o.name) ++k;
    if (k == names_.size()) {
      // A name that appears late (an emitter's first particle) has no earlier values.
      names_.push_back(o.name);
      units_.push_back(o.unit);
      values_.emplace_back(steps_.size() - 1, std::numeric_limits<double>::quiet_NaN());
    }
    if (values_[k].size() < steps_.size()) values_[k].push_back(o.value);
  }
  for (auto& v : values_) v.resize(steps_.size(), std::numeric_limits<double>::quiet_NaN());
}

// Doubling and halving are a factor of four apart, so that the stride settles.
void Series::spent(double observing_seconds, double since_seconds) {
  constexpr double kShare = 0.02;
  if (rate_ != Rate::sparing) return;
  if (observing_seconds > kShare * since_seconds) {
    stride_ = std::min(2 * stride_, uint64_t{1} << 32);
  } else if (4 * observing_seconds < kShare * since_seconds) {
    stride_ = std::max(stride_ / 2, interval_);
  }
}

void Series::thin_out() {
  interval_ *= 2;
  stride_ = std::max(stride_, interval_);
  size_t kept = 0;
  for (size_t i = 0; i < steps_.size(); ++i) {
    if (steps_[i] % interval_ != 0) continue;
    steps_[kept] = steps_[i];
    for (auto& v : values_) v[kept] = v[i];
    ++kept;
  }
  steps_.resize(kept);
  for (auto& v : values_) v.resize(kept);
}

void Series::truncate(uint64_t step) {
  while (!steps_.empty() && steps_.back() > step) {
    steps_.pop_back();
    for (auto& v : values_) v.pop_back();
  }
}

void Series::clear() {
  interval_ = stride_ = 1;
  steps_.clear();
  names_.clear();
  units_.clear();
  values_.clear();
}

size_t Series::memory_bytes() const {
  return steps_.capacity() * 8 + values_.size() * steps_.capacity() * 8;
}

size_t Series::most_bytes(const std::vector<Observation>& known) const {
  const auto kept =
      std::count_if(known.begin(), known.end(), [this](const auto& o) { return wants(o.name); });
  return active() ? max_points_ * 8 * (1 + static_cast<size_t>(kept)) : 0;
}

}  // namespace truestep
