// Contacts created by a model's events. An event that reverses a motion (a bouncing ball) happens more and
// more often with smaller and smaller flights; once a flight moves nothing by more than the tolerance, the
// states rest where the guard is zero:
//   g(t, y) = 0,  g' = dg/dt + dg/dy f = 0,  f_T <- f_T - w (g'' / w.w),  w = dg'/dy_T,
// T being the states that the event sets. The rest ends when the free motion would lift off, when g'' changes
// sign. Contacts that act on the same states are enforced one after the other, not together.
#pragma once
#include <vector>

#include "engine/integrators/advance.h"
#include "engine/systems/ode/ode_equations.h"

namespace truestep::ode {

class OdeContacts {
 public:
  /// The model must outlive this.
  explicit OdeContacts(const OdeModel& model);
  /// Per guard the side of zero to which its contact pushes, 0: it does not rest. Empty: no event can.
  void attach(std::span<int32_t> resting) { resting_ = resting; }
  void set_parameters(std::span<const double> p);

  bool possible(size_t guard) const { return !model_.contacts[guard].places.empty(); }
  bool resting(size_t guard) const { return !resting_.empty() && resting_[guard] != 0; }
  bool any() const;

  /// g' and g'' of the free motion.
  struct Motion {
    double rate, acceleration;
  };
  Motion motion(size_t guard, double t, const double* y);
  /// True when a flight starting at y moves no state of the guard by more than the tolerance and returns to
  /// where it began. `rates` is f(t, y).
  bool ends_here(size_t guard, int32_t side, double t, const double* y, const double* rates,
                 const Tolerance& tolerance);
  /// Brings the states to rest: g' = 0.
  void begin(size_t guard, int32_t side, double t, double* y);
  void end(size_t guard) { resting_[guard] = 0; }
  /// Removes from dydt the part that would leave a resting contact.
  void support(double t, const double* y, double* dydt) { support(t, y, 0, dydt); }
  /// The same for accelerations; v may be null: the velocities of `remember`.
  void support_accelerations(double t, const double* x, const double* v, double* a);
  /// Stores the whole state at the start of an integration.
  void remember(std::span<const double> y) { y_.assign(y.begin(), y.end()); }

 private:
  /// rates[index - first] for the states of all contacts.
  void support(double t, const double* y, size_t first, double* rates);
  const std::vector<double>& evaluate(size_t guard, double t, const double* y);

  const OdeModel& model_;
  std::span<int32_t> resting_;
  std::vector<OdeEvaluation> programs_;
  std::vector<double> values_, y_;
};

}  // namespace truestep::ode
