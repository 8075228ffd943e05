// Events: moments at which a function g(t, y) of the solution passes zero, found on the interpolant of each
// accepted step. Four places inside the step are looked at besides its end, so that two crossings within one
// step are seen unless they lie within a quarter of it; each is then bracketed and refined by Chandrupatla's
// method (1997, "A new hybrid quadratic/bisection algorithm for finding the zero of a nonlinear function
// without using derivatives") until t is known to rounding. A zero at the start of the run is no crossing,
// but the way back to it is. An event may stop the run at its own time; those behind it in the same step have
// not happened then.
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "engine/integrators/advance.h"

namespace truestep {

struct Event {
  std::function<double(double t, const double* y)> g;
  enum class Direction : uint8_t { rising, falling, either } direction = Direction::either;
  enum class Then : uint8_t { go_on, stop } then = Then::go_on;
};

/// Root of a continuous function between a and b where fa = f(a) and fb = f(b) have opposite signs or one is
/// 0; exact to `tolerance` (at least rounding).
double bracketed_root(const std::function<double(double)>& f, double a, double fa, double b, double fb,
                      double tolerance);

/// Watches a run for events and passes its steps on to another watcher, shortened where one stopped it.
class EventWatcher final : public StepWatcher {
 public:
  struct Hit {
    size_t event;
    double t;
  };

  /// The events must outlive the watcher; n = number of equations.
  EventWatcher(std::span<const Event> events, size_t n, StepWatcher* next = nullptr);
  /// To be called with the solution at the start of each run.
  void start(double t, const double* y);
  Verdict accepted(double t0, double& t1, double* y1, const Interpolant& between) override;

  /// In order of time, those of all runs so far.
  const std::vector<Hit>& hits() const { return hits_; }
  /// Index of the event that stopped the last run.
  std::optional<size_t> stopped_by() const { return stopped_by_; }

 private:
  static constexpr int kParts = 4;
  std::span<const Event> events_;
  StepWatcher* next_;
  std::vector<double> y_;
  std::vector<double> last_;  ///< g at the last place looked at, one per event
  std::vector<Hit> hits_, found_;
  std::optional<size_t> stopped_by_;
};

}  // namespace truestep
