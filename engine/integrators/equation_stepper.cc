#include "engine/integrators/equation_stepper.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/text/nearest_name.h"
#include "engine/base/text/short_number.h"
#include "engine/integrators/field_equations.h"
#include "engine/integrators/table/integrators.h"

namespace truestep {

namespace {

enum Work : size_t { kSteps, kRejected, kRates, kJacobians, kCounters };
constexpr const char* kCarry = "integrator.carry";
constexpr const char* kWork = "integrator.work";
constexpr const char* kMemory = "integrator.memory";

// Bounds of spectra are close, but not guaranteed for what the scene does later.
constexpr double kMargin = 0.9;

std::optional<std::string> why_not(const Integrator& m, const RightHandSide& f) {
  if (!m.advance) return "this method supports only force laws";
  return refusal(m, f);
}

const Integrator& named(const std::string& name, const RightHandSide& f) {
  const Integrator* row = find_integrator(name);
  const std::string why = row ? why_not(*row, f).value_or("") : "no integrator has this name";
  if (why.empty()) return *row;
  std::string allowed;
  std::vector<std::string> fitting;
  for (const Integrator& m : integrators()) {
    if (why_not(m, f)) continue;
    allowed += (allowed.empty() ? "" : ", ") + std::string(m.name);
    fitting.emplace_back(m.name);
  }
  const std::string shown = name.substr(0, 40);
  throw Error("scene_invalid", "integrator " + shown + ": " + why,
              {"/integrator", row ? "unsuitable_integrator" : "unknown_integrator", why, '"' + shown + '"',
               allowed, row ? "" : nearest_name(name, fitting), ""});
}

}  // namespace

EquationStepper::EquationStepper(const IntegratorChoice& choice, const Defaults& defaults,
                                 const RightHandSide& f, const Rates& rates, double dt)
    : options_(choice.options) {
  tolerance_ = tolerance_of(options_);
  if (!choice.name.empty()) {
    method_ = &named(choice.name, f), why_ = "named by the scene";
    if (const auto limit = stable_dt(rates); limit && dt > *limit) {
      why_ += ", which is stable for steps of at most " + short_number(*limit, 3) +
              " s here: use that dt, or " + std::string(defaults.divides);
      if (defaults.stiff != defaults.divides) why_ += " or " + std::string(defaults.stiff);
    }
    return;
  }
  method_ = &named(std::string(defaults.usual), f);
  const double limit =
      kMargin * stability_interval(*method_, options_).largest_step(rates.omega, rates.damping);
  if (!(dt > limit)) {
    why_ = "the default, stable for steps of up to " + short_number(limit, 3) + " s here";
    return;
  }
  why_ = std::string(defaults.usual) + " would be stable for steps of up to " + short_number(limit, 3) +
         " s only";
  const bool divide = dt <= defaults.most_divisions * limit;
  method_ = &named(std::string(divide ? defaults.divides : defaults.stiff), f);
}

std::optional<double> EquationStepper::stable_dt(const Rates& rates) const {
  if (method_->stepping == Integrator::Stepping::adaptive) return std::nullopt;
  const double dt = stability_interval(*method_, options_).largest_step(rates.omega, rates.damping);
  return std::isfinite(dt) ? std::optional(dt) : std::nullopt;
}

void EquationStepper::add_columns(State& state, size_t n) const {
  state.add({kCarry, "1", Scalar::f64, 1, Role::internal}, 2);
  state.add({kWork, "1", Scalar::u64, 1, Role::internal}, kCounters);
  const auto memory =
      state.add({kMemory, "1", Scalar::f64, 1, Role::sentinel}, method_->memory ? method_->memory(n) : 0);
  std::ranges::fill(state.f64(memory), std::nan(""));
}

void EquationStepper::step(const RightHandSide& f, double* y, State& state, const StepInput& in,
                           uint64_t surroundings) const {
  const auto carried = state.f64(state.at(kCarry));
  Carry carry{carried[0], carried[1]};
  Statistics statistics;
  Advance run{.f = f,
              .t = in.t,
              .t_end = end_of(in),
              .y = y,
              .workspace = in.workspace,
              .carry = carry,
              .tolerance = tolerance_,
              .max_steps = static_cast<uint64_t>(options_.max_internal_steps),
              .damping = options_.damping,
              .newton_tolerance = options_.newton_tolerance,
              .memory = state.f64(state.at(kMemory)),
              .surroundings = surroundings};
  run.statistics = &statistics;
  method_->advance(run);
  carried[0] = carry.step, carried[1] = carry.last_error;
  count(state, statistics);
}

// The next step begins exactly where this one ends: step lengths rounded one by one would lose time.
double EquationStepper::end_of(const StepInput& in) {
  const double counted = static_cast<double>(in.step + 1) * in.h, summed = in.t + in.h;
  return std::abs(counted - summed) < 1e-9 * in.h ? counted : summed;
}

void EquationStepper::count(State& state, const Statistics& statistics) {
  const auto done = state.span<uint64_t>(state.at(kWork));
  done[kSteps] += statistics.steps, done[kRejected] += statistics.rejected;
  done[kRates] += statistics.rates, done[kJacobians] += statistics.jacobians;
}

void EquationStepper::forget(State& state) {
  std::ranges::fill(state.f64(state.at(kCarry)), 0.0);
  std::ranges::fill(state.f64(state.at(kMemory)), std::nan(""));
}

void EquationStepper::observe(const State& state, Observables& out) {
  const auto done = state.span<uint64_t>(state.at(kWork));
  constexpr const char* kNames[] = {"integrator.steps", "integrator.rejected", "integrator.rates",
                                    "integrator.jacobians"};
  for (size_t k = 0; k < kCounters; ++k) out.add(kNames[k], static_cast<double>(done[k]), "1");
}

}  // namespace truestep
