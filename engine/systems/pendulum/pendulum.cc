#include "engine/systems/pendulum/pendulum.h"
#include "engine/core/commands/command_checks.h"

#include <cmath>

#include "engine/base/errors.h"
#include "engine/core/equations/force_outputs.h"
#include "engine/core/outputs/tabled.h"
#include "engine/integrators/table/default_method.h"

namespace truestep::pendulum {

using C = PendulumColumns;

const DefTable& pendulum_table() {
  using D = PendulumDef;
  static const DefTable kTable = [] {
    const Count per_link{0, 10000};
    TableOf<D> t("point masses on rigid massless rods, one below the other, swinging in a plane");
    t.integer("links", &D::links, between(1, 10000), "number of rods")
        .number("length", &D::length, "m", above(0), "length of every rod")
        .number("mass", &D::mass, "kg", above(0), "mass at the end of every rod")
        .number("angle", &D::angle, "rad", any(), "initial angle of every rod from the direction of gravity")
        .number("damping", &D::damping, "N s/m", at_least(0), "drag force per velocity of every mass")
        .vector("anchor", &D::anchor, "m", any(), "point where the first rod hangs")
        .numbers("lengths", &D::lengths, "m", above(0), per_link, "length of each rod, instead of length")
        .numbers("masses", &D::masses, "kg", above(0), per_link, "each mass, instead of mass")
        .numbers("angles", &D::angles, "rad", any(), per_link, "initial angle of each rod, instead of angle")
        .numbers("angular_velocities", &D::angular_velocities, "rad/s", any(), per_link,
                 "initial angular velocity of each rod; 0 when absent");
    t.check([](const D& d, const DefTable::Report& report) {
      const std::pair<const char*, const std::vector<double>*> arrays[] = {
          {"/lengths", &d.lengths},
          {"/masses", &d.masses},
          {"/angles", &d.angles},
          {"/angular_velocities", &d.angular_velocities}};
      for (const auto& [pointer, values] : arrays) {
        if (!values->empty() && values->size() != static_cast<size_t>(d.links)) {
          report(pointer, "needs one value per link, " + std::to_string(d.links) + " in all");
        }
      }
    });
    add_integrator_rows(t);
    return t.build();
  }();
  return kTable;
}

namespace {

[[noreturn]] void refuse(const std::string& pointer, const std::string& message, const std::string& allowed) {
  throw Error("bad_command", message, {pointer, "bad_command", message, "", allowed, "", ""});
}

class Pendulum final : public Tabled<Pendulum, ForceSystem> {
 public:
  static const OutputTable& outputs();

  Pendulum(std::unique_ptr<const PendulumField> field, const ChosenMethod& method, const PendulumDef& def)
      : Tabled(std::move(field), method.row, def.choice().options),
        chain_(static_cast<const PendulumField&>(force_field())) {
    add_integration_stage(method.why);
    bound_speed();
    add_stage("hands", "ends pushes whose duration is over",
              [](State& s, const StepInput& in) { C::kHands.count_down(s, in.h); });
    if (def.damping == 0) skip_stage("damping", "the damping is zero");
    show();
  }

  Energy::Exchange exchange(const State& s) const override {
    return C::kHands.any(s) ? Energy::Exchange::open : Energy::Exchange::closed;
  }

  void check(StateCheck& check, double) const override { C::kHands.check_pushes(check, chain_.links()); }

  void apply(State& s, const Command& c) const override {
    check_command_numbers(c);
    refuse_place(c, "bob");
    switch (c.kind) {
      case CommandKind::impulse: {
        const auto change = chain_.response(s.f64(C::kAngle), link(c), c.vector);
        const auto rates = s.f64(C::kAngularVelocity);
        for (size_t i = 0; i < change.size(); ++i) rates[i] += change[i];
        return;
      }
      case CommandKind::push:
        return C::kHands.add_push(s, {link(c), c.vector, {}}, c.duration);
      case CommandKind::set_parameter:
        return set_parameter(s, c);
      default:
        refuse("/type", "a pendulum takes no such command", "push, impulse, set_parameter");
    }
  }

  void draw(const State&, double, Wish wishes, Drawing& out) const override {
    if (!wants(wishes, Wish::constant)) return;
    out.parts.resize(2);
    PartDrawing& t = out.parts[0];
    t.point_radius = 0.05;
    for (uint32_t i = 0; i < chain_.links(); ++i) t.lines.push_back({i, i + 1});
    t.line_kinds.assign(t.lines.size(), LineKind::structural);
  }

 private:
  // Rows count the anchor as 0; -1 is the last mass.
  size_t link(const Command& c) const {
    const auto n = static_cast<int64_t>(chain_.links());
    if (c.index == -1) return static_cast<size_t>(n - 1);
    if (c.index < 1 || c.index > n) {
      refuse("/index", "no mass has this index", "1 to " + std::to_string(n) + ", or -1 for the last");
    }
    return static_cast<size_t>(c.index - 1);
  }

  void set_parameter(State& s, const Command& c) const {
    const bool damping = c.name == "damping";
    if (!damping && c.name != "gravity")
      refuse("/name", "no parameter " + c.name + " to set", "damping, gravity");
    // Otherwise the scene was planned for position-dependent forces only.
    if (damping && chain_.dependence() == Dependence::position) {
      refuse("/name", "damping can change only in a scene that starts with damping",
             "a scene with damping > 0");
    }
    if (!(c.value >= 0) || !std::isfinite(c.value)) refuse("/value", c.name + " is out of range", ">= 0");
    s.f64(damping ? C::kDamping : C::kGravity)[0] = c.value;
  }

  const PendulumField& chain_;
};

const OutputTable& Pendulum::outputs() {
  using P = Pendulum;
  static const OutputTable kTable =
      OutputsOf<P>("the pivot (0) and the masses (1 ...); in part joints the links (0 ...)")
          .part("", [](const P& p) { return points_part(p.chain_.links() + 1); })
          .field({"position", "m", Scalar::f64, 3, Meaning::position},
                 computed_by<P>([](const P& p, const State& s, ShownRows, double* out) {
                   p.chain_.positions(s.f64(C::kAngle), out);
                 }),
                 "of pivot and masses")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity},
                 computed_by<P>([](const P& p, const State& s, ShownRows, double* out) {
                   p.chain_.velocities(s.f64(C::kAngle), s.f64(C::kAngularVelocity), out);
                 }),
                 "")
          .part("joints", [](const P& p) { return values_part(p.chain_.links()); })
          .field({"angle", "rad", Scalar::f64, 1, Meaning::angle}, column(C::kAngle),
                 "of a link from the downward vertical")
          .field({"angular_velocity", "rad/s"}, column(C::kAngularVelocity), "")
          .measured(force_energies, kForceEnergyRows)
          .measured(held_steps, kHeldStepsRows)
          .build();
  return kTable;
}

}  // namespace

const Outputs& pendulum_outputs() {
  static const Outputs kDescribed = Pendulum::outputs().described();
  return kDescribed;
}

std::unique_ptr<const System> make_pendulum(const void* def, const BuildContext& context) {
  const auto& d = *static_cast<const PendulumDef*>(def);
  auto field = std::make_unique<PendulumField>(d, context.gravity);
  // Links that flip over rotate many times faster than any did at the start: an adaptive method copes with
  // that.
  const ChosenMethod method =
      settle_method(d.choice(), {.usual = "dop853", .stiff = "radau5"}, *field, context.dt);
  return std::make_unique<Pendulum>(std::move(field), method, d);
}

Cost cost_pendulum(const void* def) {
  const double n = static_cast<const PendulumDef*>(def)->links;
  return {.state_bytes = 512 + 16 * n,
          .workspace_bytes = 4096 + 150 * n,
          .elements = n,
          .seconds_per_step = 2e-6 + 3e-7 * n};
}

}  // namespace truestep::pendulum
