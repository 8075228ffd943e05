// Embedded pairs (tableau.h) on force fields: as many internal steps as the tolerance asks for, never over
// the end of the session's step. The next internal step and the last error live in the state, so a restored
// run repeats every choice. Control of the step: step_control.h; where a pair's last stage is the next
// internal step's first, it is not evaluated again, except across session steps, because commands may have
// changed anything. The tolerance bounds the largest component of the error in x and in v, in their own
// units, plus relative_tolerance times the component.
#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/interrupt.h"
#include "engine/base/short_number.h"
#include "engine/integrators/control/step_control.h"
#include "engine/integrators/explicit/runge_kutta.h"
#include "engine/integrators/explicit/tableau_dop853.h"
#include "engine/integrators/table/methods.h"

namespace truestep {

namespace {

constexpr std::string_view kInternalStep = "integrator.internal_step";
constexpr std::string_view kLastError = "integrator.last_error";

// Of the session's step: shorter ones say that the method cannot go on. A jump of the acceleration (joint
// limits, linkages that pass through one line) is crossed where it times the step is below the tolerance.
constexpr double kShortest = 1e-14;

[[noreturn]] void give_up(const Motion& m, double t, double h) {
  const auto bad = m.state.first_bad();
  throw Instability("", "position", bad ? static_cast<long long>(bad->row) : -1,
                    "the tolerance cannot be met at t = " + short_number(t) +
                        " s: the internal step fell to " + short_number(h, 2) + " s");
}

// The larger one, or NaN when one is NaN (fmax would drop it).
double worse(double a, double b) {
  return a > b || a != a ? a : b;
}

// attempt(t, h) leaves a candidate and returns its error over the tolerance; accept(h) takes it.
template <class Attempt, class Accept>
void subdivide(Motion& m, const step_control::Law& law, int most, Attempt attempt, Accept accept) {
  const double length = m.input.h;
  const auto column = m.state.at(kInternalStep), error_column = m.state.at(kLastError);
  double h = m.state.f64(column)[0];
  step_control::Controller control(law, m.state.f64(error_column)[0]);
  if (!(h > 0)) h = length;
  double done = 0;
  for (int tried = 0;; ++tried) {
    interruption_point();
    if (tried >= most) {
      const auto count = static_cast<uint64_t>(most);
      throw Instability("", "position", -1, step_control::too_many_steps_message(count, m.input.t + done, h));
    }
    const double left = length - done;
    const bool last = h >= left * (1 - 1e-12);
    // Less than two steps left: two equal ones, so that no sliver remains.
    const double now = last ? left : 2 * h > left ? 0.5 * left : h;
    const double error = attempt(m.input.t + done, now);
    if (!(error <= 1)) {
      h = now * control.rejected(error * error);
      if (h < kShortest * length) give_up(m, m.input.t + done, h);
      continue;
    }
    accept(now);
    const double factor = control.accepted(error * error, now);
    h = now < h ? std::max(h, now * factor) : now * factor;
    if (last) break;
    done += now;
  }
  m.state.f64(column)[0] = std::min(h, length);
  m.state.f64(error_column)[0] = control.last_error();
}

void step_pair(const Tableau& tableau, const step_control::Law& law, const ForceField& field, State& state,
               const StepInput& in, const IntegratorOptions& options) {
  Motion m(field, state, in);
  RungeKutta rk(tableau, m);
  const ErrorScale scale{options.absolute_tolerance.value_or(options.tolerance),
                         options.relative_tolerance.value_or(0)};
  const auto error_of = [&](double h, const Tableau::Weights& w) {
    return worse(largest(m, m.x.size(), rk.position_terms(h, w, m.v), m.x.data(), scale),
                 largest(m, m.v.size(), rk.velocity_terms(h, w), m.v.data(), scale));
  };
  bool first_stands = false;
  const auto attempt = [&](double t, double h) {
    for (size_t i = first_stands ? 1 : 0; i < tableau.stages; ++i) rk.stage(i, t, h, m.x, m.v);
    first_stands = true;
    const double error = error_of(h, tableau.error);
    if (!tableau.two_errors() || !(error > 0)) return error;
    const double ratio = error_of(h, tableau.second_error) / error;
    return error / std::sqrt(1 + 0.01 * ratio * ratio);
  };
  const auto accept = [&](double h) {
    // Position first: its terms contain the old velocity.
    combine(m, m.x.size(), m.x.data(), m.x.data(), rk.position_terms(h, tableau.b, m.v));
    combine(m, m.v.size(), m.v.data(), m.v.data(), rk.velocity_terms(h, tableau.b));
    first_stands = tableau.first_same_as_last();
    if (first_stands) rk.last_stage_becomes_first();
  };
  subdivide(m, law, options.max_internal_steps, attempt, accept);
  m.project();
}

}  // namespace

void prepare_adaptive(const ForceField&, State& s) {
  s.add({std::string(kInternalStep), "s", Scalar::f64, 1, Role::internal}, 1);
  s.add({std::string(kLastError), "1", Scalar::f64, 1, Role::internal}, 1);
}

void step_step_doubling(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions& o) {
  step_pair(kStepDoublingTableau, {.q = 5, .beta = 0}, f, s, in, o);
}
void step_bs32(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions& o) {
  step_pair(kBs32Tableau, {.q = 3}, f, s, in, o);
}
void step_rkf45(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions& o) {
  step_pair(kRkf45Tableau, {.q = 5}, f, s, in, o);
}
void step_dopri5(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions& o) {
  step_pair(kDopri5Tableau, {.q = 5}, f, s, in, o);
}
void step_ssprk104(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions& o) {
  step_pair(kSsprk104Tableau, {.q = 4, .beta = 0.1, .foresight = 0}, f, s, in, o);
}
void step_tsit5(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions& o) {
  step_pair(kTsit5Tableau, {.q = 5}, f, s, in, o);
}
void step_dop853(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions& o) {
  step_pair(kDop853Tableau, {.q = 8, .beta = 0, .safety = 0.9, .shrink = 1.0 / 3, .grow = 6}, f, s, in, o);
}

}  // namespace truestep
