#include "engine/systems/fem/fem.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/collision/points/idle_colliders.h"
#include "engine/integrators/implicit/impulse_answer.h"
#include "engine/integrators/table/integrators.h"
#include "engine/systems/fem/fem_choice.h"

namespace truestep::fem {

using Columns = FemColumns;

namespace {

constexpr std::string_view kUsual = "implicit_euler", kLinear = "linear_implicit_euler",
                           kMeetsBodies = "velocity_verlet";
constexpr std::string_view kOldPosition = "fem.x_old", kOldVelocity = "fem.v_old";

ChosenMethod settle(const FemDef& def, const BuildContext& context, const FemField& field) {
  const IntegratorChoice choice = def.choice();
  if (!choice.name.empty()) return {choose_integrator(choice, "", field), "named by the scene"};
  if (context.meets_bodies) {
    return {choose_integrator(choice, kMeetsBodies, field),
            "the default for contact with bodies: every node responds on its own"};
  }
  return {choose_integrator(choice, kUsual, field), "the default, stable for any step"};
}

void remember(State& s, const StepInput& in) {
  const auto copy = [&](State::Column c, std::string_view key) {
    const auto now = s.f64(c);
    std::copy(now.begin(), now.end(), in.workspace.doubles(key, now.size()).begin());
  };
  copy(Columns::position, kOldPosition);
  copy(Columns::velocity, kOldVelocity);
}

}  // namespace

Fem::Fem(std::unique_ptr<const FemField> field, const ChosenMethod& method, const FemDef& def, double dt)
    : Tabled(std::move(field), method.row, def.choice().options),
      elements_(static_cast<const FemField&>(force_field())),
      motion_(def.motion),
      colliders_(build_colliders(def.colliders)),
      radius_(def.contact == Meeting::barrier ? 0 : def.contact_distance.value_or(0)),
      idle_(idle(colliders_, body().mesh.x, radius_)),
      step_seconds_(step_seconds(def, &method.row)),
      answer_seconds_(fem::answer_seconds(def)),
      locking_(locking_of(def)) {
  for (const Collider& c : colliders_.colliders()) {
    surfaces_.push_back(c.surface);
    surfaces_.back().restitution = def.restitution;
    if (def.friction) surfaces_.back().friction = *def.friction;
  }
  if (def.contact == Meeting::barrier) add_barrier(def);
  plan_stages(def, method.why);
  drawing_.triangles = body().mesh.triangles();
  drawing_.triangle_elements = body().mesh.triangle_cells();
  if (body().plane) drawing_.space = PartDrawing::Space::plane;
  show();
  if (def.modes > 0) frequencies_ = natural_frequencies(elements_, def.modes);
  if (motion_ == Motion::dynamic && def.holds.empty()) bound_speed();
  if (motion_ == Motion::quasi_static || barrier_) set_integration({});
  if (motion_ == Motion::quasi_static) {
    set_remedies({"a longer load_time or a smaller dt, so that a step adds less load",
                  "a material that resists collapse (neo_hookean)",
                  "motion dynamic with damping, if the body snaps from one shape to another"});
  } else {
    set_remedies({"a smaller dt", "integrator implicit_euler, which damps motion too fast for the step",
                  "a smaller load"});
  }
}

void Fem::add_barrier(const FemDef& def) {
  const auto refuse = [](const std::string& pointer, const std::string& message) {
    throw Error("scene_invalid", pointer + ": " + message, {pointer, "bad_contact", message, "", "", "", ""});
  };
  constexpr double kUsualReach = 1e-3, kWidest = 0.5;
  BarrierSurface surface(body(), colliders_, surfaces_, def.friction.value_or(Surface{}.friction));
  const double widest = kWidest * surface.shortest_edge();
  const double reach = def.contact_distance.value_or(std::min(kUsualReach * body().mesh.diagonal(), widest));
  if (reach > widest) {
    refuse("/contact_distance",
           "a barrier reaches at most half the shortest edge of the surface, " + short_number(widest) + " m");
  }
  const State start = elements_.initial_state();
  if (const auto what = surface.entangled(start.f64(Columns::position), 0))
    refuse("/contact", "with a barrier nothing may touch at the start, but " + *what);
  barrier_ = std::make_unique<const BarrierStep>(elements_, std::move(surface), reach);
}

std::string Fem::elements_of(const FemDef& def) const {
  const Element& kind = *body().mesh.kind;
  std::string out = "; " + std::string(kind.name) + ", " + choose_cell(def).why;
  if (kind.points.size() > 1 && !body().mesh.sheet && !body().plane_stress)
    out += std::string("; volume ") + (body().mean_volume ? "mean: " : "pointwise: ") + volume_reason(def);
  return out;
}

void Fem::plan_stages(const FemDef& def, const std::string& why) {
  if (def.fill) {
    std::vector<std::array<uint32_t, 4>> tetrahedra;
    for (size_t k = 0; k < body().mesh.cells(); ++k) {
      const auto nodes = body().mesh.cell(k);
      tetrahedra.push_back({nodes[0], nodes[1], nodes[2], nodes[3]});
    }
    const auto angles = dihedral_angles(body().mesh.x, tetrahedra);
    constexpr double kDegree = 3.14159265358979323846 / 180;
    skip_stage("fill", "made when the scene was built: " + std::to_string(tetrahedra.size()) +
                           " tetrahedra, angles between their faces from " +
                           short_number(angles[0] / kDegree, 3) + " to " +
                           short_number(angles[1] / kDegree, 4) + " degrees");
  }
  const std::string elements = elements_of(def);
  if (motion_ == Motion::quasi_static) {
    add_stage("equilibrium", "displacements in equilibrium, by Newton's method with line search" + elements,
              [this](State& s, const StepInput& in) { equilibrium(s, in); });
    skip_stage("integrate", "motion is quasi-static");
  } else {
    add_dynamic_stages(def, why, elements);
    if (!(def.damping > 0)) skip_stage("damping", "damping is 0");
  }
  add_stage("hands", "ends pushes whose duration is over",
            [](State& s, const StepInput& in) { Columns::kHands.count_down(s, in.h); });
  if (def.holds.empty()) skip_stage("holds", "no displacement is prescribed");
}

void Fem::add_dynamic_stages(const FemDef& def, const std::string& why, const std::string& elements) {
  if (!def.holds.empty()) {
    add_stage("holds", std::to_string(def.holds.size()) + " sets have prescribed displacements",
              [this](State& s, const StepInput& in) { begin_holds(s, in.t, in.h); });
  }
  if (barrier_) {
    add_stage("barrier", "implicit Euler with a barrier against contact, by Newton's method" + elements,
              [this](State& s, const StepInput& in) { barrier_->step(s, in); });
    skip_stage("contacts", "the barrier prevents them");
  } else if (colliders_.empty()) {
    add_integration_stage(why + elements);
    skip_stage("contacts", "there are no colliders");
  } else {
    add_contact_stages(why + elements);
  }
  if (!def.holds.empty()) {
    add_stage("velocities of holds", "prescribed components take the velocities of their expressions",
              [this](State& s, const StepInput& in) { end_holds(s, in.t, in.h); });
  }
}

// Methods that solve for a step keep nodes on surfaces within the solve: putting nodes back afterwards would
// squeeze the elements behind them, which keeps adding energy to a stiff body.
void Fem::add_contact_stages(const std::string& why) {
  const std::string count = std::to_string(colliders_.colliders().size());
  if (solves_contacts()) {
    add_stage("integrate",
              "advances position and velocity with " + std::string(integrator().name) + ", nodes on " +
                  count + " colliders held to them: " + why,
              [this](State& s, const StepInput& in) { step_on_surfaces(s, in); });
    return;
  }
  add_stage("remember", "contacts need the previous position of every node", remember);
  add_integration_stage(why);
  add_stage("contacts", count + " colliders keep the nodes out",
            [this](State& s, const StepInput& in) { resolve_contacts(s, in); });
}

bool Fem::solves_contacts() const {
  return motion_ == Motion::dynamic && !barrier_ && !colliders_.empty() &&
         (integrator().name == kUsual || integrator().name == kLinear);
}

State Fem::initial_state() const {
  State s = ForceSystem::initial_state();
  if (solves_contacts()) RowContacts::add_columns(s, s.rows(Columns::position));
  return s;
}

void Fem::step_on_surfaces(State& s, const StepInput& in) const {
  const Body& b = body();
  const bool driven =
      Columns::kHands.any(s) || !b.pressures.empty() || !b.holds.empty() || elements_.load_share(in.t) < 1;
  on_surfaces_.step(force_field(), integrator(), options(), s, in,
                    driven ? SurfaceContacts::Supply::some : SurfaceContacts::Supply::none);
}

void Fem::resolve_contacts(State& s, const StepInput& in) const {
  const size_t n = s.f64(Columns::position).size();
  colliders_.resolve({.t = in.t,
                      .h = in.h,
                      .x_old = in.workspace.doubles(kOldPosition, n),
                      .v_old = in.workspace.doubles(kOldVelocity, n),
                      .x = s.f64(Columns::position),
                      .v = s.f64(Columns::velocity),
                      .inverse_mass = s.f64(Columns::inverse_mass),
                      .radius = radius_,
                      .surfaces = surfaces_},
                     in.workspace, in.arena);
}

std::optional<double> Fem::limit(Limit which, const State& s, double h) const {
  if (which == Limit::step_seconds) return step_seconds_;
  return motion_ == Motion::quasi_static ? std::nullopt : ForceSystem::limit(which, s, h);
}

Energy::Exchange Fem::exchange(const State& s) const {
  const Body& b = body();
  const bool driven = barrier_ || Columns::kHands.any(s) || !idle_ || !b.pressures.empty() ||
                      !b.holds.empty() || elements_.load_share(0) < 1;
  return driven ? Energy::Exchange::open : Energy::Exchange::closed;
}

std::optional<Energy> Fem::energy(const State& s, double t, Workspace& workspace,
                                  const ThreadArena& arena) const {
  if (motion_ == Motion::quasi_static) return std::nullopt;
  return ForceSystem::energy(s, t, workspace, arena);
}

Ports Fem::ports() const {
  if (motion_ == Motion::quasi_static || body().plane || barrier_) return {};
  return {.points = PointPort{.position = Columns::position,
                              .velocity = Columns::velocity,
                              .mass = std::nullopt,
                              .inverse_mass = Columns::inverse_mass,
                              .id = std::nullopt,
                              .radius = radius_},
          .solids = {drawing_.triangles, {}},
          .bodies = std::nullopt,
          .answers = integrator().kind == Integrator::Kind::implicit ? this : nullptr};
}

void Fem::answer(State& state, const StepInput& in, Answer which, std::span<const double> impulses,
                 std::span<double> dv) const {
  answer_implicitly(force_field(), options(), state, in, which, impulses, dv);
}

void Fem::draw(const State&, double t, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::constant)) {
    out.parts.resize(parts().size());
    out.parts[0] = drawing_;
  }
  if (wants(wishes, Wish::obstacles)) out.obstacles = colliders_.drawn(t);
}

void Fem::check(StateCheck& check, double) const {
  const size_t points = check.state().rows(Columns::position);
  check.together({Columns::drag_row, Columns::drag_target, Columns::drag_stiffness})
      .together({Columns::push_row, Columns::push_force, Columns::push_remaining});
  for (const auto column : {Columns::drag_row, Columns::push_row}) {
    for (const uint32_t row : check.state().span<uint32_t>(column))
      check.require(row < points, "the row of a push or drag");
  }
  check.require(check.state().f64(Columns::parameters)[0] > 0, "Young's modulus");
}

std::unique_ptr<const Fem> Fem::make(const FemDef& def, const BuildContext& context) {
  auto field = std::make_unique<const FemField>(def, context);
  const ChosenMethod method = settle(def, context, *field);
  return std::unique_ptr<const Fem>(new Fem(std::move(field), method, def, context.dt));
}

std::unique_ptr<const System> build_fem(const void* def, const BuildContext& context) {
  return Fem::make(*static_cast<const FemDef*>(def), context);
}

}  // namespace truestep::fem
