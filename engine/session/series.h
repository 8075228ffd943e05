// Observables over time within a bound in points: when it is full every other point goes and the sampling
// interval doubles.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/observables.h"

namespace truestep {

class Series {
 public:
  /// Names to keep, or their beginnings up to a dot ("energy" keeps energy.total); empty keeps nothing.
  explicit Series(std::vector<std::string> wanted, size_t max_points = 4096);

  bool active() const { return !wanted_.empty(); }
  /// Whether this step is one to sample.
  bool due(uint64_t step) const {
    return active() && step % interval_ == 0 && (steps_.empty() || step > steps_.back());
  }
  void add(uint64_t step, const Observables& values);
  /// Forgets points after `step`.
  void truncate(uint64_t step);
  void clear();

  const std::vector<uint64_t>& steps() const { return steps_; }
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<std::string>& units() const { return units_; }
  /// Values of one name, one per step of `steps`.
  const std::vector<double>& values(size_t name) const { return values_[name]; }
  size_t memory_bytes() const;

 private:
  bool wants(std::string_view name) const;
  void thin_out();

  std::vector<std::string> wanted_;
  size_t max_points_;
  uint64_t interval_ = 1;
  std::vector<uint64_t> steps_;
  std::vector<std::string> names_, units_;
  std::vector<std::vector<double>> values_;
};

}  // namespace truestep
