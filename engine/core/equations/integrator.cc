// What the table's rows say about a system: where they are stable, and which systems they serve.
#include "engine/core/equations/integrator.h"

#include <algorithm>
#include <limits>

#include "engine/core/equations/right_hand_side.h"

namespace truestep {

double StabilityInterval::largest_step(double omega, double damping) const {
  double step = std::numeric_limits<double>::infinity();
  if (omega > 0) step = imaginary / omega;
  if (damping > 0) step = std::min(step, real / damping);
  return step;
}

StabilityInterval stability_interval(const Integrator& method, const IntegratorOptions& options) {
  return method.interval ? method.interval(options)
                         : StabilityInterval{method.imaginary_limit, method.real_limit};
}

std::optional<std::string> refusal(const Integrator& method, const ForceField& field) {
  if (method.order_with_velocity == 0 && field.dependence() == Dependence::position_and_velocity) {
    return "the acceleration depends on velocity, which this method cannot treat";
  }
  return method.refuses ? method.refuses(field) : std::nullopt;
}

std::optional<std::string> refusal(const Integrator& method, const RightHandSide& f) {
  if (!method.advance) return "the method needs a system that is made of forces";
  if (method.equations == Integrator::Equations::any) return std::nullopt;
  const SecondOrder* second = f.second_order();
  if (!second) return "the method needs equations of second order, x'' = a(t, x, v)";
  if (method.equations == Integrator::Equations::without_velocity && second->depends_on_velocity()) {
    return "the acceleration depends on velocity, which this method cannot treat";
  }
  return std::nullopt;
}

}  // namespace truestep
