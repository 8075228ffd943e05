#include "engine/integrators/table/default_method.h"

#include <charconv>
#include <cmath>

#include "engine/integrators/control/spectrum.h"
#include "engine/integrators/table/integrators.h"

namespace truestep {

namespace {

// The rates are those of the initial state, and power iteration approaches them from below.
constexpr double kMargin = 0.8;
// Internal steps of an explicit method per step of the scene up to which they are cheaper than solving.
constexpr double kMostDivisions = 50;

std::string number(double v) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, v, std::chars_format::general, 3).ptr};
}

ForceField::Stiffness fastest(const ForceField& field, const State& start) {
  if (const auto known = field.stiffness(start)) return *known;
  const Spectrum s = estimate_spectrum(field, start, 0, kRoughSpectrum);
  return {s.omega, s.damping};
}

}  // namespace

ChosenMethod settle_method(const IntegratorChoice& choice, const DefaultMethods& defaults,
                           const ForceField& field, double dt) {
  const Integrator& usual = choose_integrator(choice, defaults.usual, field);
  if (!choice.name.empty()) return {usual, "named by the scene"};
  const ForceField::Stiffness rates = fastest(field, field.initial_state());
  const auto holds = [&](const Integrator& method) {
    return kMargin * stability_interval(method, choice.options).largest_step(rates.omega, rates.damping);
  };
  const double limit = holds(usual);
  if (!(dt > limit)) return {usual, "the default, stable for this step"};
  const std::string why = "the fastest motion at the start, " + number(std::max(rates.omega, rates.damping)) +
                          " 1/s, is too fast for " + std::string(usual.name) + " beyond " + number(limit) +
                          " s";
  const Integrator* divides = find_integrator(defaults.divides);
  if (divides && refusal(*divides, field)) divides = nullptr;
  const double divisions = divides ? dt / holds(*divides) : INFINITY;
  if (divisions <= kMostDivisions) return {*divides, why + ", so steps are divided"};
  const Integrator* stiff = find_integrator(defaults.stiff);
  if (stiff && !refusal(*stiff, field)) return {*stiff, why + ", so the step is implicit"};
  return {divides ? *divides : usual, why};
}

}  // namespace truestep
