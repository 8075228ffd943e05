#include "engine/systems/oscillator/oscillator.h"
#include "engine/core/commands/command_checks.h"

#include <cmath>
#include <utility>

#include "engine/base/errors.h"
#include "engine/core/equations/force_outputs.h"
#include "engine/core/outputs/tabled.h"
#include "engine/integrators/table/default_method.h"

namespace truestep::oscillator {

const DefTable& oscillator_table() {
  using D = OscillatorDef;
  static const DefTable kTable = [] {
    TableOf<D> t("a mass on a spring along the first axis, optionally damped and driven");
    t.number("mass", &D::mass, "kg", above(0), "mass of the point")
        .number("stiffness", &D::stiffness, "N/m", at_least(0), "spring constant")
        .number("damping", &D::damping, "N s/m", at_least(0), "damping force per velocity")
        .number("position", &D::position, "m", any(), "initial distance from the rest position")
        .number("velocity", &D::velocity, "m/s", any(), "initial velocity")
        .number("drive_force", &D::drive_force, "N", any(), "amplitude of the driving force")
        .number("drive_frequency", &D::drive_frequency, "Hz", at_least(0), "frequency of the driving force");
    add_integrator_rows(t);
    return t.build();
  }();
  return kTable;
}

namespace {

[[noreturn]] void refuse(const std::string& pointer, const std::string& message, const std::string& allowed) {
  throw Error("bad_command", message, {pointer, "bad_command", message, "", allowed, "", ""});
}

class Oscillator final : public Tabled<Oscillator, ForceSystem> {
 public:
  using C = OscillatorColumns;

  Oscillator(const OscillatorDef& def, std::unique_ptr<const ForceField> field, const ChosenMethod& method)
      : Tabled(std::move(field), method.row, def.choice().options), def_(def) {
    show();
    add_integration_stage(method.why);
    bound_speed();
    add_stage("hands", "ends pushes whose duration is over",
              [](State& s, const StepInput& in) { C::kHands.count_down(s, in.h); });
    if (def.drive_force == 0) skip_stage("drive", "the driving force is zero");
    if (def.damping == 0) skip_stage("damping", "the damping is zero");
  }

  static const OutputTable& outputs();

  Energy::Exchange exchange(const State& s) const override {
    const bool driven = s.f64(C::kDriveForce)[0] != 0 || C::kHands.any(s);
    return driven ? Energy::Exchange::open : Energy::Exchange::closed;
  }

  void check(StateCheck& check, double) const override { C::kHands.check_pushes(check, 1); }

  void apply(State& state, const Command& c) const override {
    check_command_numbers(c);
    refuse_place(c, "mass");
    if (c.index > 0 || c.index < -1) refuse("/index", "an oscillator has a single point", "0");
    switch (c.kind) {
      case CommandKind::impulse:
        state.f64(C::kVelocity)[0] += c.vector.x * state.f64(C::kInverseMass)[0];
        break;
      case CommandKind::push:
        C::kHands.add_push(state, {0, c.vector, {}}, c.duration);
        break;
      case CommandKind::set_parameter:
        set_parameter(state, c);
        break;
      default:
        refuse("/type", "an oscillator takes no such command", "push, impulse, set_parameter");
    }
    state.f64(C::kDisturbed)[0] = 1;
  }

  void draw(const State&, double, Wish wishes, Drawing& out) const override {
    if (!wants(wishes, Wish::constant)) return;
    PartDrawing& mass = out.parts.emplace_back();
    mass.point_radius = 0.05;
    mass.space = PartDrawing::Space::plane;
  }

 private:
  struct Error {
    std::optional<double> exact;
  };
  Error error(const State& state, double t) const {
    if (def_.drive_force != 0 || state.f64(C::kDisturbed)[0] != 0) return {};
    return {std::abs(state.f64(C::kPosition)[0] - oscillator_exact(def_, t).x)};
  }
  void set_parameter(State& s, const Command& c) const {
    static constexpr std::pair<std::string_view, C::Index> kSettable[] = {
        {"stiffness", C::kStiffness},
        {"damping", C::kDamping},
        {"mass", C::kInverseMass},
        {"drive_force", C::kDriveForce},
        {"drive_frequency", C::kDriveFrequency}};
    for (const auto& [name, column] : kSettable) {
      if (c.name != name) continue;
      // Without damping the scene was planned for position-dependent forces only.
      if (column == C::kDamping && def_.damping == 0) {
        refuse("/name", "damping can change only in a scene that starts with damping",
               "a scene with damping > 0");
      }
      const bool positive = column == C::kInverseMass, any_sign = column == C::kDriveForce;
      if (!std::isfinite(c.value) || (!any_sign && c.value < 0) || (positive && c.value == 0)) {
        refuse("/value", c.name + " is out of range", positive ? "> 0" : ">= 0");
      }
      s.f64(column)[0] = positive ? 1 / c.value : c.value;
      return;
    }
    refuse("/name", "no parameter " + c.name + " to set",
           "stiffness, damping, mass, drive_force, drive_frequency");
  }

  OscillatorDef def_;
};

const OutputTable& Oscillator::outputs() {
  static const OutputTable kTable =
      OutputsOf<Oscillator>("the mass: only row 0")
          .part("", [](const Oscillator&) { return points_part(1); })
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(C::kPosition), "only x changes")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(C::kVelocity), "")
          .measured(force_energies, kForceEnergyRows)
          .measured(held_steps, kHeldStepsRows)
          .measured(&Oscillator::error,
                    {{"error.exact", "m", &Error::exact,
                      "difference from the exact solution, until a command disturbs it and while it is not "
                      "driven"}})
          .build();
  return kTable;
}

}  // namespace

const Outputs& oscillator_outputs() {
  static const Outputs kDescribed = Oscillator::outputs().described();
  return kDescribed;
}

std::unique_ptr<const System> make_oscillator(const void* def, const BuildContext& context) {
  const auto& d = *static_cast<const OscillatorDef*>(def);
  auto field = make_oscillator_field(d);
  const ChosenMethod method = settle_method(d.choice(), {.usual = "rk4"}, *field, context.dt);
  return std::make_unique<Oscillator>(d, std::move(field), method);
}

Cost cost_oscillator(const void*) {
  return {.state_bytes = 512, .workspace_bytes = 4096, .elements = 1, .seconds_per_step = 3e-7};
}

}  // namespace truestep::oscillator
