// Compares what a run should measure (the scene's `expect`) with what it did measure.
//
// A drift is max |value - initial value| / scale, the scale being the largest |initial value| of the
// quantities of the same group and unit ("energy." in J), or 1 where all of them start at 0: the drift is
// then absolute, in the quantity's unit.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/expected_quantity.h"
#include "engine/session/world/world.h"

namespace truestep {

struct Verdict {
  ExpectParams expected;
  std::optional<double> measured;  ///< empty when no such quantity exists
  bool met = false;
  /// What a drift was divided by; 0: by nothing, it is absolute. Absent for anything but a drift.
  std::optional<double> drift_scale;
};

/// Watches a run. Observables are computed at every step only if an expectation needs the whole run.
class Expectations {
 public:
  /// Error "scene_invalid" for a quantity that cannot be read.
  explicit Expectations(const Scene& scene);
  bool empty() const { return watched_.empty(); }
  /// Whether the values at every step matter (min, max, drift ...), not just those at the end.
  bool needs_every_step() const;
  /// Whether an observable of this name matters.
  bool wants(std::string_view observable) const;
  /// The values at time t; calls come in the order of time.
  void add(const Observables& values, double t);
  /// Verdicts after the last `add`.
  std::vector<Verdict> verdicts() const;

 private:
  /// What has been seen of one reduced term.
  struct Seen {
    std::optional<double> first, value, least, greatest;
    double largest = 0, deviation = 0, sum = 0, count = 0;
    double scale = 0;  ///< of a drift
    std::optional<double> first_potential, lowest_potential;
  };
  struct Watched {
    ExpectParams expected;
    ExpectedQuantity quantity;
    std::vector<Seen> seen;  ///< per track
    double t = 0;            ///< of the last value within the window
  };
  static void add_to(Seen& seen, const QuantityTrack& track, const Observables& values, double t);
  static std::optional<double> reduced(const Seen& seen, Reduction reduction, double given);
  std::vector<Watched> watched_;
};

}  // namespace truestep
