#include "engine/session/snapshot/history.h"

#include <algorithm>

namespace truestep {
namespace {

constexpr double kShare = 0.005;  // share of the run's time spent on snapshots

// Seconds per snapshot, measured on memory touched for the first time: page faults dominate.
double copy_seconds(size_t bytes) {
  return 1e-6 + 3e-10 * static_cast<double>(bytes);
}

}  // namespace

void History::set_cadence(size_t bytes, double step_seconds) {
  // An interrupted step looks long: at most twice the last figure is believed.
  step_seconds_ = step_seconds_ > 0 ? std::min(step_seconds, 2 * step_seconds_) : step_seconds;
  const double wanted = copy_seconds(bytes) / (kShare * step_seconds_);
  while (cadence_ < kMostCadence && static_cast<double>(cadence_) < wanted) cadence_ *= 2;
  while (cadence_ > kLeastCadence && 0.5 * static_cast<double>(cadence_) >= wanted) cadence_ /= 2;
}

void History::offer(const WorldState& state, double step_seconds) {
  set_cadence(state.memory_bytes(), step_seconds);
  if (due(state.step)) keep(state);
}

void History::keep(const WorldState& state) {
  if (!snapshots_.empty() && snapshots_.back().step >= state.step) return;
  const bool regular = due(state.step);
  const size_t size = state.memory_bytes();
  WorldState place;
  // Spare memory that does not fit (states with emitters grow) is freed before the past is thinned.
  while (!spare_.empty() || !fits(bytes_ + size)) {
    if (spare_.empty()) {
      if (snapshots_.empty()) return;
      thin_out();
      if (regular && !due(state.step)) return;
      continue;
    }
    place = std::move(spare_.back());
    spare_.pop_back();
    bytes_ -= place.memory_bytes();
    if (fits(bytes_ + std::max(size, place.memory_bytes()))) break;
    place = {};
  }
  place = state;
  bytes_ += place.memory_bytes();
  snapshots_.push_back(std::move(place));
}

// Keeps only multiples of the doubled spacing.
void History::thin_out() {
  spacing_ *= 2;
  const auto gone = std::stable_partition(snapshots_.begin(), snapshots_.end(),
                                          [&](const WorldState& s) { return s.step % spacing_ == 0; });
  std::move(gone, snapshots_.end(), std::back_inserter(spare_));
  snapshots_.erase(gone, snapshots_.end());
}

const WorldState* History::at_or_before(uint64_t step) const {
  for (size_t i = snapshots_.size(); i-- > 0;) {
    if (snapshots_[i].step <= step) return &snapshots_[i];
  }
  return nullptr;
}

void History::truncate(uint64_t step) {
  while (!snapshots_.empty() && snapshots_.back().step > step) {
    spare_.push_back(std::move(snapshots_.back()));
    snapshots_.pop_back();
  }
}

void History::forget_before(uint64_t step) {
  const auto kept =
      std::find_if(snapshots_.begin(), snapshots_.end(), [&](const WorldState& s) { return s.step >= step; });
  std::move(snapshots_.begin(), kept, std::back_inserter(spare_));
  snapshots_.erase(snapshots_.begin(), kept);
}

void History::clear() {
  snapshots_.clear();
  spare_.clear();
  bytes_ = 0;
  if (room_) room_(0);
  cadence_ = spacing_ = kLeastCadence;
  step_seconds_ = 0;
}

std::vector<const WorldState*> History::snapshots() const {
  std::vector<const WorldState*> out;
  for (const WorldState& s : snapshots_) out.push_back(&s);
  return out;
}

std::vector<uint64_t> History::steps() const {
  std::vector<uint64_t> out;
  for (const WorldState& s : snapshots_) out.push_back(s.step);
  return out;
}

}  // namespace truestep
