#include "engine/systems/ode/ode_contacts.h"

#include <algorithm>
#include <cmath>

namespace truestep::ode {

OdeContacts::OdeContacts(const OdeModel& model) : model_(model), y_(model.size()) {
  size_t most = 0;
  for (const OdeModel::Contact& c : model.contacts) {
    programs_.emplace_back(c.program);
    most = std::max(most, c.program.outputs());
  }
  values_.resize(most);
}

void OdeContacts::set_parameters(std::span<const double> p) {
  for (OdeEvaluation& e : programs_) e.set_parameters(p);
}

bool OdeContacts::any() const {
  return std::ranges::any_of(resting_, [](int32_t side) { return side != 0; });
}

const std::vector<double>& OdeContacts::evaluate(size_t guard, double t, const double* y) {
  programs_[guard](t, y, model_.size(), model_.parameter_values.size(), values_.data());
  return values_;
}

OdeContacts::Motion OdeContacts::motion(size_t guard, double t, const double* y) {
  const auto& v = evaluate(guard, t, y);
  return {v[0], v[1]};
}

bool OdeContacts::ends_here(size_t guard, int32_t side, double t, const double* y, const double* rates,
                            const Tolerance& tolerance) {
  const Motion m = motion(guard, t, y);
  const double away = side * m.rate, pressed = -side * m.acceleration;
  if (!(away >= 0) || !(pressed > 0)) return false;
  // A parabola: its apex is at half of the flight, half as high as the first rate alone would lead until
  // then.
  const double reach = 0.5 * away / pressed;
  for (const uint32_t i : model_.contacts[guard].watched) {
    const double absolute = tolerance.absolute_each.empty() ? tolerance.absolute : tolerance.absolute_each[i];
    if (!(std::abs(rates[i]) * reach <= absolute + tolerance.relative * std::abs(y[i]))) return false;
  }
  return true;
}

void OdeContacts::begin(size_t guard, int32_t side, double t, double* y) {
  const auto& v = evaluate(guard, t, y);
  const auto& places = model_.contacts[guard].places;
  double w2 = 0;
  for (size_t i = 0; i < places.size(); ++i) w2 += v[2 + i] * v[2 + i];
  if (!(w2 > 0)) return;
  for (size_t i = 0; i < places.size(); ++i) y[places[i]] -= v[2 + i] * (v[0] / w2);
  resting_[guard] = side;
}

void OdeContacts::support(double t, const double* y, size_t first, double* rates) {
  for (size_t k = 0; k < resting_.size(); ++k) {
    if (resting_[k] == 0) continue;
    const auto& v = evaluate(k, t, y);
    const auto& places = model_.contacts[k].places;
    double w2 = 0;
    for (size_t i = 0; i < places.size(); ++i) w2 += v[2 + i] * v[2 + i];
    if (!(w2 > 0)) continue;
    for (size_t i = 0; i < places.size(); ++i) rates[places[i] - first] -= v[2 + i] * (v[1] / w2);
  }
}

void OdeContacts::support_accelerations(double t, const double* x, const double* v, double* a) {
  const size_t half = model_.size() / 2;
  std::copy_n(x, half, y_.begin());
  if (v) std::copy_n(v, half, y_.begin() + static_cast<std::ptrdiff_t>(half));
  // The contacts' states are velocities here; their rates are the accelerations.
  support(t, y_.data(), half, a);
}

}  // namespace truestep::ode
