#include "engine/systems/articulation/articulation.h"

#include <algorithm>
#include <cmath>

#include "engine/core/commands/command_checks.h"

namespace truestep::articulation {

namespace {

// Implicit Euler damps joints whose effective masses stay the same. Where links whip they do not, and a step
// of these methods that gains energy or has no solution is taken again in parts; energies are summed only
// where a joint turns by more than kTurns, rad, in a step. Swept over free chains of 10 to 40 links at 0.25
// to 17 ms: the most that is gained falls from 65 of 785 J to 3.3 J with a bound of 1e-4 for what a step may
// gain, to 3.5 J (and 5.6 J) with 1e-3, to 30 J with 1e-2; more than 8 parts change nothing.
constexpr std::string_view kFirstOrder[] = {"implicit_euler", "linear_implicit_euler"};
constexpr double kTurns = 0.01;
constexpr RisingStep::Bounds kRising{.rise = 1e-4, .most_parts = 8};

bool all_have_shapes(const ArticulationDef& d) {
  return std::ranges::none_of(d.links, [](const LinkDef& l) { return l.shapes.empty(); });
}

}  // namespace

Articulation::Articulation(std::unique_ptr<const ArticulationField> field, const ChosenMethod& method,
                           const ArticulationDef& def)
    : Tabled(std::move(field), method.row, def.choice().options),
      tree_(static_cast<const ArticulationField&>(force_field())),
      rising_(tree_, kRising),
      point_radius_(def.point_radius.value_or(all_have_shapes(def) ? 0 : 0.03)),
      color_(def.color) {
  add_method_stage(method.why);
  bound_speed();
  if (tree_.model().closures.empty()) {
    skip_stage("loops", "the links are a tree");
  } else {
    add_stage("loops", "removes the gaps that the step left in loops", [this](State& s, const StepInput& in) {
      close(tree_.model().tree, tree_.model().closures, s.f64(Columns::kPosition), s.f64(Columns::kVelocity),
            in.workspace.object<ClosureWork>("articulation.closures"));
    });
  }
  add_stage("hands", "ends pushes whose duration is over",
            [](State& s, const StepInput& in) { Columns::kHands.count_down(s, in.h); });
  const auto& drives = tree_.model().drives;
  if (std::ranges::none_of(drives, [](const Drive& d) { return d.limited(); })) {
    skip_stage("limits", "no joint has limits");
  }
  show();
}

void Articulation::add_method_stage(const std::string& why) {
  if (std::ranges::find(kFirstOrder, integrator().name) == std::end(kFirstOrder)) {
    return add_integration_stage(why);
  }
  add_stage("integrate",
            "advances position and velocity with " + std::string(integrator().name) + ": " + why +
                "; a step that gains energy where links turn, or has no solution, is taken again in up to " +
                std::to_string(kRising.most_parts) + " parts",
            [this](State& s, const StepInput& in) { integrate(s, in); });
}

void Articulation::integrate(State& s, const StepInput& in) const {
  using Supply = RisingStep::Supply;
  rising_.step_in_parts(
      s, in, exchange(s) == Energy::Exchange::open ? Supply::some : Supply::none,
      [this](std::span<const double> v0, std::span<const double> v, double h) {
        return std::ranges::any_of(tree_.model().tree.nodes, [&](const Node& n) {
          if (n.move != Move::revolute && n.move != Move::spherical) return false;
          for (uint32_t k = n.v; k < n.v + velocities_of(n.move); ++k) {
            if (std::max(std::abs(v0[k]), std::abs(v[k])) * h > kTurns) return true;
          }
          return false;
        });
      },
      [this](State& to, const StepInput& at) { integrator().step(tree_, to, at, options()); });
}

Ports Articulation::ports() const {
  std::call_once(reached_, [this] { links_ = std::make_unique<const LinkBodies>(tree_); });
  Ports out;
  out.bodies.emplace().forms = links_->forms();
  out.bodies->owner = links_.get();
  return out;
}

Energy::Exchange Articulation::exchange(const State& s) const {
  const auto torque = s.f64(Columns::kTorque);
  const bool driven = !tree_.model().loads.empty() || Columns::kHands.any(s) ||
                      std::ranges::any_of(torque, [](double t) { return t != 0; });
  return driven ? Energy::Exchange::open : Energy::Exchange::closed;
}

void Articulation::check(StateCheck& check, double) const {
  Columns::kHands.check_pushes(check, tree_.model().links.size());
}

void Articulation::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  const Model& m = tree_.model();
  switch (c.kind) {
    case CommandKind::impulse: {
      const size_t link = checked_command_row(c, m.links.size(), "link");
      const auto change = tree_.response(s, link, c.vector, tree_.hold(s, link, c.at));
      const auto v = s.f64(Columns::kVelocity);
      for (size_t i = 0; i < change.size(); ++i) v[i] += change[i];
      return;
    }
    case CommandKind::push: {
      const size_t link = checked_command_row(c, m.links.size(), "link");
      return Columns::kHands.add_push(s, {link, c.vector, tree_.hold(s, link, c.at)}, c.duration);
    }
    case CommandKind::set_parameter: {
      if (c.name == "gravity") return store3(s.f64(Columns::kGravity).data(), 0, c.vector);
      for (const Link& l : m.links) {
        if (l.id.empty() || c.name != l.id + ".torque") continue;
        if (l.velocities == 0) refuse_command("name", "unknown_parameter", "a fixed joint has no torque");
        s.f64(Columns::kTorque)[l.v] = c.value;
        return;
      }
      refuse_command("name", "unknown_parameter", "no parameter " + c.name + " to set",
                     "gravity, <link>.torque");
    }
    default:
      refuse_command("type", "unsupported_command", "an articulation takes no such command",
                     "push, impulse, set_parameter");
  }
}

}  // namespace truestep::articulation

namespace truestep::articulation {

std::unique_ptr<const System> build_articulation(const void* def, const BuildContext& context) {
  const auto& d = *static_cast<const ArticulationDef*>(def);
  auto field = std::make_unique<articulation::ArticulationField>(articulation::build_model(d),
                                                                 d.gravity.value_or(context.gravity));
  // Links that flip and loops that fold reach rates many times those at the start: an adaptive method follows
  // them, with springs an implicit one. That takes too long for many unknowns.
  constexpr size_t kFew = 64;
  const std::string_view stiff =
      field->initial_state().f64(articulation::Columns::kVelocity).size() <= kFew ? "radau5" : "bdf2";
  const ChosenMethod method =
      settle_method(d.choice(), {.usual = "dop853", .stiff = stiff}, *field, context.dt);
  return std::make_unique<articulation::Articulation>(std::move(field), method, d);
}

Cost articulation_cost(const void* def) {
  const auto& d = *static_cast<const ArticulationDef*>(def);
  double n = 0;
  for (const LinkDef& l : d.links) n += l.copies ? static_cast<double>(l.copies->count) : 1;
  // Every row of a loop costs one solve of the tree, and a column of up to six numbers per link.
  const double rows = 3 * static_cast<double>(d.closures.size());
  return {.state_bytes = 512 + 80 * n,
          .workspace_bytes = 4096 + 1500 * n + 8 * rows * (6 * n + rows),
          .elements = n + rows + static_cast<double>(d.springs.size()),
          .seconds_per_step = 1e-6 + 4e-6 * n * (1 + rows) + 4e-9 * rows * rows * rows};
}

}  // namespace truestep::articulation
