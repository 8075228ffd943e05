#include "engine/systems/heat/heat.h"

#include <algorithm>
#include <cmath>

#include "engine/base/byte_hash.h"
#include "engine/base/errors.h"
#include "engine/core/commands/command_checks.h"
#include "engine/lattice/lattice_state.h"

namespace truestep::heat {

using lattice::Constants;
using lattice::LatticeWork;

namespace {

lattice::Texts texts(const HeatDef& d) {
  return {.initial = {{"/initial", d.initial}},
          .coefficient = {"/diffusivity", d.diffusivity},
          .source = {"/source", d.source}};
}

Constants constants(const State& s) {
  return {.coefficient = s.f64(kConstants)[0]};
}

}  // namespace

void HeatEquations::jacobian(double t, const double*, double* values) const {
  work_.move_to(t);
  std::ranges::copy(work_.matrix().values, values);
}

std::optional<double> HeatEquations::spectral_radius(double t, const double*) const {
  work_.move_to(t);
  return work_.spectral_radius();
}

LinearSolver* HeatEquations::linear_solver() const {
  return work_.solver() ? const_cast<HeatEquations*>(this) : nullptr;
}

Heat::Heat(const HeatDef& def, const BuildContext& context)
    : def_(def), model_(def, lattice::SideKind::neumann, texts(def)) {
  show();
  set_remedies({"a shorter dt", "the integrator rkc2, whose number of stages follows dt",
                "an implicit integrator such as sdirk4"});
  static const ThreadArena kSerial(1);
  LatticeWork work;
  work.bind(model_, {.coefficient = model_.constant_coefficient().value_or(0)}, kSerial);
  const HeatEquations f(work, model_.lattice(), kSerial);
  const EquationStepper::Defaults defaults{
      .usual = "rk4", .divides = "rkc2", .most_divisions = 4000, .stiff = "sdirk4"};
  stepper_.emplace(def.choice(), defaults, f, Rates{.damping = work.spectral_radius()}, context.dt);
  set_integration({&method(), &stepper_->options(), nullptr});
  add_stage("integrate",
            std::to_string(f.size()) + " nodes with " + std::string(stepper_->method().name) + ": " +
                stepper_->why(),
            [this](State& s, const StepInput& in) { integrate(s, in); });
  if (!model_.forced()) skip_stage("forcing", "the source and the sides' values are zero");
}

State Heat::initial_state() const {
  State s;
  lattice::add_column(s, {"value", "K", Scalar::f64, 1, Role::position}, model_.initial(0));
  lattice::add_column(s, {"constants", "1", Scalar::f64, 1, Role::internal},
                      {model_.constant_coefficient().value_or(0)});
  stepper_->add_columns(s, model_.lattice().nodes());
  return s;
}

void Heat::integrate(State& s, const StepInput& in) const {
  auto& work = in.workspace.object<LatticeWork>("heat");
  work.bind(model_, constants(s), in.arena);
  const HeatEquations f(work, model_.lattice(), in.arena);
  const auto values = s.bytes(kConstants);
  try {
    stepper_->step(f, s.f64(kValue).data(), s, in, byte_hash(values.data(), values.size()));
  } catch (Instability& e) {
    e.quantity = "value";
    throw;
  }
}

std::optional<double> Heat::limit(Limit which, const State& s, double) const {
  // With the method that the step's length chose.
  if (which == Limit::step_seconds) return lattice::lattice_step_seconds(def_, stepper_->method().name);
  if (which != Limit::stable_dt) return std::nullopt;
  static const ThreadArena kSerial(1);
  LatticeWork work;
  work.bind(model_, constants(s), kSerial);
  return stepper_->stable_dt({.damping = work.spectral_radius()});
}

std::optional<Energy> Heat::energy(const State& s, double, Workspace& workspace, const ThreadArena&) const {
  const auto u = s.f64(kValue);
  const auto squares = workspace.doubles("heat.squares", u.size());
  for (size_t i = 0; i < u.size(); ++i) squares[i] = 0.5 * u[i] * u[i];
  Energy e;
  e.potential = lattice::integral(model_.lattice(), squares);
  e.exchange = model_.forced() ? Energy::Exchange::open : Energy::Exchange::closed;
  return e;
}

void Heat::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  if (c.kind == CommandKind::impulse) {
    lattice::add_at(model_.lattice(), c, c.vector.x / def_.heat_capacity, s.f64(kValue));
  } else if (c.kind == CommandKind::set_parameter) {
    if (c.name != "diffusivity") {
      refuse_command("name", "unknown_parameter", "no parameter " + c.name + " to set", "diffusivity");
    }
    if (!model_.constant_coefficient()) {
      refuse_command("name", "not_a_number", "the scene's diffusivity is an expression",
                     "a scene whose diffusivity is a number");
    }
    if (!(c.value > 0)) refuse_command("value", "out_of_range", "the diffusivity must be positive", "> 0");
    s.f64(kConstants)[0] = c.value;
  } else {
    refuse_command("type", "unsupported_command", "heat takes no such command", "impulse, set_parameter");
  }
  EquationStepper::forget(s);
}

std::unique_ptr<const System> build_heat(const void* def, const BuildContext& context) {
  return std::make_unique<Heat>(*static_cast<const HeatDef*>(def), context);
}

}  // namespace truestep::heat
