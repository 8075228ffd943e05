#include "engine/systems/molecular/molecular.h"

#include "engine/core/command_checks.h"

namespace truestep::molecular {

Molecular::Molecular(std::unique_ptr<const MolecularField> field, const ChosenMethod& method)
    : ForceSystem(std::move(field), method.row,
                  static_cast<const MolecularField&>(*field).def().choice().options),
      atoms_(static_cast<const MolecularField&>(force_field())) {
  const MolecularDef& d = atoms_.def();
  main_part().fields.push_back({"speed", "m/s"});
  std::vector<PartInfo> all{main_part()};
  if (d.sides == Sides::periodic) {
    PartInfo g;
    g.kind = PartInfo::Kind::values, g.name = "distribution";
    g.fields = {{"distance", "m"}, {"density", "1"}};
    g.max_rows = static_cast<size_t>(d.distribution_bins);
    all.push_back(g);
  }
  set_parts(std::move(all));
  add_stage(
      "neighbours", "a new list where somebody may have moved half a skin",
      [this](State& s, const StepInput& in) { atoms_.renew_reference(s, in.h, in.arena, in.workspace); });
  add_integration_stage(method.why);
  bound_speed();
}

std::unique_ptr<const Molecular> Molecular::make(const MolecularDef& def, const BuildContext& context) {
  auto field = std::make_unique<const MolecularField>(def, context);
  const ChosenMethod method = settle_method(def.choice(), {.usual = "velocity_verlet"}, *field, context.dt);
  return std::unique_ptr<const Molecular>(new Molecular(std::move(field), method));
}

void Molecular::apply(State&, const Command& c) const {
  check_command_numbers(c);
  refuse_command("kind", "not_possible", "atoms take no commands");
}

void Molecular::draw(const State&, double, Wish wishes, Drawing& out) const {
  if (!wants(wishes, Wish::constant)) return;
  out.parts.resize(parts().size());
  out.parts[0].point_radius = atoms_.def().draw_radius;
  if (const auto& c = atoms_.def().color) out.parts[0].color = {c->x, c->y, c->z};
}

std::unique_ptr<const System> build_molecular(const void* def, const BuildContext& context) {
  return Molecular::make(*static_cast<const MolecularDef*>(def), context);
}

}  // namespace truestep::molecular
