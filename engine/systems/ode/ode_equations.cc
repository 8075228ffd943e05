#include "engine/systems/ode/ode_equations.h"

#include "engine/systems/ode/ode_contacts.h"
#include "engine/systems/ode/ode_slides.h"

namespace truestep::ode {

OdeEquations::OdeEquations(const OdeModel& model)
    : model_(model),
      parameters_(model.parameter_values.size()),
      rate_(model.rate),
      jacobian_(model.jacobian.program),
      acceleration_(model.acceleration),
      acceleration_jacobian_(model.acceleration_jacobian.program),
      both_(model.acceleration_jacobian.program.outputs()) {}

void OdeEquations::set_parameters(std::span<const double> p) {
  for (OdeEvaluation* e : {&rate_, &jacobian_, &acceleration_, &acceleration_jacobian_}) e->set_parameters(p);
}

void OdeEquations::slide(OdeEvaluation& of, double t, const double* y) const {
  const auto sides = slides_->sides(inside(t), y);
  for (size_t k = 0; k < sides.size(); ++k) of.set_parameter(slides_->first() + k, sides[k]);
}

const double* OdeEquations::both(const double* x, const double* v) const {
  const size_t half = model_.size() / 2;
  states_.assign(x, x + half);
  states_.insert(states_.end(), v, v + half);
  return states_.data();
}

void OdeEquations::support_rates(double t, const double* y, double* dydt) const {
  contacts_->support(t, y, dydt);
}
void OdeEquations::support_accelerations(double t, const double* x, const double* v, double* a) const {
  contacts_->support_accelerations(t, x, v, a);
}

void OdeEquations::jacobian(double t, const double* x, const double* v, double* dadx, double* dadv) const {
  acceleration_jacobian_(inside(t), x, v, model_.size() / 2, parameters_, both_.data());
  const size_t half = both_.size() / 2;
  std::copy_n(both_.data(), half, dadx);
  std::copy_n(both_.data() + half, half, dadv);
}

}  // namespace truestep::ode
