// Observables over time, bounded in points: when full, every other point is dropped and the sampling interval
// doubles. A sparing series also adapts to the clock: when observing takes more than a fiftieth of the time
// between two points, the next points are twice as far apart. Intervals are powers of two.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/observables.h"

namespace truestep {

class Series {
 public:
  /// every_step: the sampled points depend only on the steps.
  enum class Rate : uint8_t { every_step, sparing };
  /// Names to keep, or their prefixes up to a dot ("energy" keeps energy.total); empty keeps nothing.
  explicit Series(std::vector<std::string> wanted, Rate rate = Rate::every_step, size_t max_points = 4096);

  bool active() const { return !wanted_.empty(); }
  /// Whether values of this name are kept.
  bool wants(std::string_view name) const;
  /// Whether this step is sampled.
  bool due(uint64_t step) const {
    return active() && step % stride_ == 0 && (steps_.empty() || step > steps_.back());
  }
  void add(uint64_t step, const Observables& values);
  /// The time that the newest point took, and the time since the previous one; a sparing series adapts.
  void spent(double observing_seconds, double since_seconds);
  /// Forgets points after `step`.
  void truncate(uint64_t step);
  void clear();

  const std::vector<uint64_t>& steps() const { return steps_; }
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<std::string>& units() const { return units_; }
  /// Values of one name, one per step of `steps`.
  const std::vector<double>& values(size_t name) const { return values_[name]; }
  size_t memory_bytes() const;
  /// Largest memory it may take, given the existing names.
  size_t most_bytes(const std::vector<Observation>& known) const;

 private:
  void thin_out();

  std::vector<std::string> wanted_;
  Rate rate_;
  size_t max_points_;
  uint64_t interval_ = 1;  ///< of the points kept when full
  uint64_t stride_ = 1;    ///< of the points to come, a multiple of interval_
  std::vector<uint64_t> steps_;
  std::vector<std::string> names_, units_;
  std::vector<std::vector<double>> values_;
};

}  // namespace truestep
