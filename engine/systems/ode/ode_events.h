// Events on the way of an integration: crossings of zero by a guard g(t, y), looked for at the end and at
// three points inside every accepted internal step and then located by bisection on the method's
// interpolant, to the last bit of the step's fraction. A guard that crosses and comes back between two of
// these points is missed. After an event has fired, its guard
// counts from the next point on, unless the event itself moved it back across zero.
// Unlike integrators/events.h this keeps the sides in the system's state, so that a restored run repeats
// every event, and evaluates all guards as one program.
#pragma once
#include <vector>

#include "engine/integrators/advance.h"
#include "engine/systems/ode/ode_equations.h"

namespace truestep {

class OdeCrossings final : public StepWatcher {
 public:
  explicit OdeCrossings(const OdeModel& model);
  void set_parameters(std::span<const double> p) { guards_.set_parameters(p); }
  /// Side of zero per event, as remembered in the state; `accepted` updates it.
  void attach(std::span<int32_t> signs) { signs_ = signs; }

  Verdict accepted(double t0, double& t1, double* y1, const Interpolant& between) override;

  /// Events that fired when `accepted` last said stop, in their order.
  const std::vector<uint32_t>& fired() const { return fired_; }
  void clear() {
    fired_.clear();
    fired_side_.clear();
  }
  /// Takes the present sides of all guards as their past ones; 0 for those that fired and that nothing has
  /// moved back since: rounding decides on which side of zero these stand.
  void look(double t, const double* y);

 private:
  void evaluate(double t, const double* y);
  bool crosses(size_t event) const;

  const OdeModel& model_;
  OdeEvaluation guards_;
  std::span<int32_t> signs_;
  std::vector<double> values_, point_;
  std::vector<uint32_t> fired_;
  std::vector<int32_t> fired_side_;  ///< per event that fired, the side that it crossed to
};

}  // namespace truestep
