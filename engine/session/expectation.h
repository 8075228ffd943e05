// Compares what a run should measure (the scene's `expect`) with what it did measure.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/session/world/world.h"

namespace truestep {

struct Verdict {
  ExpectParams expected;
  std::optional<double> measured;  ///< empty when no such quantity exists
  bool met = false;
  /// What a drift was divided by; 0: by nothing, it is absolute. Absent for anything but a drift.
  std::optional<double> drift_scale;
};

/// How a run's values of an observable are reduced to one.
enum class Reduction : uint8_t { last, min, max, drift };
struct ExpectedQuantity {
  Reduction reduction = Reduction::last;
  std::string name;  ///< of an observable
};
/// Parses "energy.total", "max(rope.strain.max)", "energy.drift".
ExpectedQuantity expected_quantity(const std::string& text);

/// Watches a run. Observables are computed at every step only if an expectation needs the whole run.
class Expectations {
 public:
  explicit Expectations(const Scene& scene);
  bool empty() const { return watched_.empty(); }
  /// Whether the values at every step matter (min, max, drift), not just those at the end.
  bool needs_every_step() const;
  void add(const Observables& values);
  /// Verdicts after the last `add`.
  std::vector<Verdict> verdicts() const;

 private:
  struct Watched {
    ExpectParams expected;
    ExpectedQuantity quantity;
    std::optional<double> first, value, least, greatest, deviation;
    double scale = 0;  ///< of a drift
  };
  std::vector<Watched> watched_;
};

}  // namespace truestep
