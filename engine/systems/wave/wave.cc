#include "engine/systems/wave/wave.h"

#include <algorithm>
#include <cmath>

#include "engine/base/byte_hash.h"
#include "engine/base/errors.h"
#include "engine/core/commands/command_checks.h"
#include "engine/lattice/lattice_state.h"

namespace truestep::wave {

using lattice::Constants;
using lattice::LatticeWork;

namespace {

lattice::Texts texts(const WaveDef& d) {
  return {.initial = {{"/initial", d.initial}, {"/initial_rate", d.initial_rate}},
          .coefficient = {"/speed", d.speed},
          .source = {"/source", d.source},
          .squared = lattice::Texts::Squared::yes,
          .time_order = 2};
}

Constants constants(const State& s) {
  return {.coefficient = s.f64(kConstants)[0], .damping = s.f64(kConstants)[1]};
}

Rates rates(LatticeWork& work, double damping) {
  return {.omega = std::sqrt(work.spectral_radius()), .damping = damping};
}

}  // namespace

Wave::Wave(const WaveDef& def, const BuildContext& context)
    : def_(def), model_(def, lattice::SideKind::dirichlet, texts(def)) {
  show();
  set_remedies({"a shorter dt", "the integrator implicit_midpoint, which is stable for any dt"});
  static const ThreadArena kSerial(1);
  LatticeWork work;
  work.bind(model_, {model_.constant_coefficient().value_or(0), def.damping}, kSerial);
  const WaveEquations f(work, model_.lattice(), def.damping, kSerial);
  const EquationStepper::Defaults defaults{.usual = "leapfrog",
                                           .divides = "implicit_midpoint",
                                           .most_divisions = HUGE_VAL,
                                           .stiff = "implicit_midpoint"};
  stepper_.emplace(def.choice(), defaults, f, rates(work, def.damping), context.dt);
  set_integration({&method(), &stepper_->options(), nullptr});
  add_stage("integrate",
            std::to_string(model_.lattice().nodes()) + " nodes with " + std::string(stepper_->method().name) +
                ": " + stepper_->why(),
            [this](State& s, const StepInput& in) { integrate(s, in); });
  if (!model_.forced()) skip_stage("forcing", "the source and the sides' values are zero");
  if (def.damping == 0) skip_stage("damping", "the damping is zero");
}

State Wave::initial_state() const {
  State s;
  lattice::add_column(s, {"value", "m", Scalar::f64, 1, Role::position}, model_.initial(0));
  lattice::add_column(s, {"rate", "m/s", Scalar::f64, 1, Role::velocity}, model_.initial(1));
  lattice::add_column(s, {"constants", "1", Scalar::f64, 1, Role::internal},
                      {model_.constant_coefficient().value_or(0), def_.damping});
  stepper_->add_columns(s, 2 * model_.lattice().nodes());
  return s;
}

void Wave::integrate(State& s, const StepInput& in) const {
  auto& work = in.workspace.object<LatticeWork>("wave");
  work.bind(model_, constants(s), in.arena);
  // The usual method in one sweep over the state itself: with the table's implementation a million nodes take
  // nine times as long (bench heat).
  const bool undamped_leapfrog = s.f64(kConstants)[1] == 0 && stepper_->method().name == "leapfrog";
  if (const double h = EquationStepper::end_of(in) - in.t;
      undamped_leapfrog &&
      work.leapfrog_in_place(in.t + 0.5 * h, h, s.f64(kValue).data(), s.f64(kRate).data())) {
    return EquationStepper::count(s, {.steps = 1, .rates = 1});
  }
  const WaveEquations f(work, model_.lattice(), s.f64(kConstants)[1], in.arena);
  const size_t n = model_.lattice().nodes();
  const auto y = in.workspace.doubles("wave.y", 2 * n);
  std::ranges::copy(s.f64(kValue), y.begin());
  std::ranges::copy(s.f64(kRate), y.begin() + static_cast<ptrdiff_t>(n));
  const auto values = s.bytes(kConstants);
  try {
    stepper_->step(f, y.data(), s, in, byte_hash(values.data(), values.size()));
  } catch (Instability& e) {
    const auto i = static_cast<size_t>(e.index);
    e.quantity = e.index >= 0 && i >= n ? "rate" : "value";
    if (e.index >= 0) e.index = static_cast<long long>(i % n);
    throw;
  }
  std::copy_n(y.begin(), n, s.f64(kValue).begin());
  std::copy_n(y.begin() + static_cast<ptrdiff_t>(n), n, s.f64(kRate).begin());
}

std::optional<Energy> Wave::energy(const State& s, double t, Workspace& workspace,
                                   const ThreadArena& arena) const {
  auto& work = workspace.object<LatticeWork>("wave");
  work.bind(model_, constants(s), arena);
  work.move_to(t);
  Energy e;
  const auto v = s.f64(kRate);
  const auto squares = workspace.doubles("wave.squares", v.size());
  for (size_t i = 0; i < v.size(); ++i) squares[i] = 0.5 * v[i] * v[i];
  e.kinetic = lattice::integral(model_.lattice(), squares);
  e.potential = work.potential(s.f64(kValue).data());
  const bool open = model_.forced() || model_.coefficient_moves();
  e.exchange = open ? Energy::Exchange::open : Energy::Exchange::closed;
  const Integrator& m = stepper_->method();
  const bool limited = m.kind == Integrator::Kind::explicit_ && m.stepping == Integrator::Stepping::fixed;
  e.swing = limited ? Energy::kSwingNearLimit : Energy::kSwing;
  return e;
}

std::optional<double> Wave::limit(Limit which, const State& s, double) const {
  // With the method that the step's length chose.
  if (which == Limit::step_seconds) return lattice::lattice_step_seconds(def_, stepper_->method().name);
  if (which != Limit::stable_dt) return std::nullopt;
  static const ThreadArena kSerial(1);
  LatticeWork work;
  work.bind(model_, constants(s), kSerial);
  return stepper_->stable_dt(rates(work, s.f64(kConstants)[1]));
}

void Wave::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  if (c.kind == CommandKind::impulse) {
    lattice::add_at(model_.lattice(), c, c.vector.x, s.f64(kRate));
  } else if (c.kind == CommandKind::set_parameter) {
    if (c.name == "speed") {
      if (!model_.constant_coefficient()) {
        refuse_command("name", "not_a_number", "the scene's speed is an expression",
                       "a scene whose speed is a number");
      }
      if (!(c.value > 0)) refuse_command("value", "out_of_range", "the speed must be positive", "> 0");
      s.f64(kConstants)[0] = c.value * c.value;
    } else if (c.name == "damping") {
      // Without damping the scene was planned for position-dependent forces only.
      if (def_.damping == 0) {
        refuse_command("name", "planned_without",
                       "damping can change only in a scene that starts with damping",
                       "a scene with damping > 0");
      }
      if (!(c.value >= 0)) refuse_command("value", "out_of_range", "the damping must be at least 0", ">= 0");
      s.f64(kConstants)[1] = c.value;
    } else {
      refuse_command("name", "unknown_parameter", "no parameter " + c.name + " to set", "speed, damping");
    }
  } else {
    refuse_command("type", "unsupported_command", "waves take no such command", "impulse, set_parameter");
  }
  EquationStepper::forget(s);
}

std::unique_ptr<const System> build_wave(const void* def, const BuildContext& context) {
  return std::make_unique<Wave>(*static_cast<const WaveDef*>(def), context);
}

}  // namespace truestep::wave
