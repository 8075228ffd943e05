#include "engine/systems/molecular/molecular.h"

#include "engine/core/commands/command_checks.h"

namespace truestep::molecular {

Molecular::Molecular(std::unique_ptr<const MolecularField> field, const ChosenMethod& method,
                     const IntegratorOptions& options)
    : Tabled(std::move(field), method.row, options),
      atoms_(static_cast<const MolecularField&>(force_field())) {
  show();
  set_remedies({"a step of at most a twentieth of the fastest vibration's period",
                "a start whose atoms do not overlap"});
  if (has_own_step()) set_integration({});
  plan_stages(method.why);
  bound_speed();
}

void Molecular::plan_stages(const std::string& why) {
  using Method = ThermostatDef::Method;
  const MolecularDef& d = atoms_.def();
  const auto holds = [&](Method m) { return d.thermostat && d.thermostat->method == m; };
  const auto chain = [this](State& s, const StepInput& in) { half_chain(s, in); };
  add_stage(
      "neighbours", "a new list when an atom may have moved half a skin",
      [this](State& s, const StepInput& in) { atoms_.renew_reference(s, in.h, in.arena, in.workspace); });
  if (holds(Method::nose_hoover)) add_stage("chain before", "half a step of the thermostat", chain);
  if (has_own_step()) {
    const std::string noise =
        holds(Method::langevin) ? ", friction and noise in the middle of the drift" : "";
    const std::string rigid = d.water ? ", rigid molecules by SETTLE" : "";
    add_stage("integrate", "velocity_verlet" + noise + rigid,
              [this](State& s, const StepInput& in) { advance_own(s, in); });
  } else {
    add_integration_stage(why);
  }
  if (holds(Method::nose_hoover)) add_stage("chain after", "the other half", chain);
  if (holds(Method::velocity_rescaling)) {
    add_stage("thermostat", "the kinetic energy follows the canonical distribution",
              [this](State& s, const StepInput& in) { rescale(s, in); });
  }
  if (!d.thermostat) skip_stage("thermostat", "none given: the energy is conserved");
  if (d.barostat) {
    add_stage("barostat",
              "the box follows the pressure, every " + std::to_string(d.barostat->every) + " steps",
              [this](State& s, const StepInput& in) { change_box(s, in); });
  } else {
    skip_stage("barostat", "none given: the box is fixed");
  }
}

bool Molecular::has_own_step() const {
  const MolecularDef& d = atoms_.def();
  return d.water || (d.thermostat && d.thermostat->method == ThermostatDef::Method::langevin);
}

Energy::Exchange Molecular::exchange(const State&) const {
  return atoms_.def().thermostat ? Energy::Exchange::open : Energy::Exchange::closed;
}

std::unique_ptr<const Molecular> Molecular::make(const MolecularDef& def, const BuildContext& context) {
  auto field = std::make_unique<const MolecularField>(def, context);
  // Too long a step is an error that suggests a shorter one: adaptive methods would take millions.
  const ChosenMethod method{choose_integrator(def.choice(), "velocity_verlet", *field),
                            def.integrator.empty() ? "the default" : "named by the scene"};
  return std::unique_ptr<const Molecular>(new Molecular(std::move(field), method, def.choice().options));
}

void Molecular::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  if (c.kind != CommandKind::set_parameter) {
    refuse_command("type", "not_possible", "atoms take no other command", "set_parameter");
  }
  const MolecularDef& d = atoms_.def();
  const bool temperature = c.name == "temperature" && d.thermostat,
             pressure = c.name == "pressure" && d.barostat;
  if (!temperature && !pressure) {
    refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set",
                   "temperature (with a thermostat), pressure (with a barostat)");
  }
  if (temperature && !(c.value > 0)) refuse_command("value", "out_of_range", "the value must be above 0");
  s.f64(Columns::bath)[static_cast<size_t>(temperature ? Bath::temperature : Bath::pressure)] = c.value;
}

void Molecular::draw(const State&, double, Wish wishes, Drawing& out) const {
  if (!wants(wishes, Wish::constant)) return;
  const MolecularDef& d = atoms_.def();
  out.parts.resize(parts().size());
  PartDrawing& t = out.parts[0];
  const auto color = [](const std::optional<Vec3>& c) {
    return c ? std::optional(std::array{c->x, c->y, c->z}) : std::nullopt;
  };
  t.color = color(d.color);
  const auto row = [](int64_t i) { return static_cast<uint32_t>(i); };
  for (const BondDef& b : d.bonds) t.lines.push_back({row(b.a), row(b.b)});
  for (const auto& [o, h, k] : atoms_.start().waters) t.lines.push_back({o, h}), t.lines.push_back({o, k});
  if (!d.has_looks()) {
    t.point_radius = d.draw_radius;
    return;
  }
  for (const KindDef& k : d.kinds) {
    Visual& v = t.visuals.emplace_back();
    v.shape.size = {k.draw_radius.value_or(d.draw_radius), 0, 0};
    v.color = color(k.color ? k.color : d.color), v.group = static_cast<uint32_t>(t.visuals.size());
  }
  const auto& kinds = atoms_.kinds();
  for (uint32_t i = 0; i < kinds.size(); ++i) t.instances.push_back({i, kinds[i]});
}

std::unique_ptr<const System> build_molecular(const void* def, const BuildContext& context) {
  return Molecular::make(*static_cast<const MolecularDef*>(def), context);
}

}  // namespace truestep::molecular
