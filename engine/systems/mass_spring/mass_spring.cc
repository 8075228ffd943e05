#include "engine/systems/mass_spring/mass_spring.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/points/idle_colliders.h"
#include "engine/integrators/implicit/implicit.h"
#include "engine/integrators/implicit/impulse_answer.h"
#include "engine/integrators/table/integrators.h"

namespace truestep::mass_spring {

using Columns = MassSpringColumns;

namespace {

// One Newton step per step, unconditionally stable while a spring's direction does not change. A spring that
// turns is stretched by half the square of the angle, which adds energy if it is stiff.
constexpr std::string_view kUsual = "linear_implicit_euler", kStiff = "implicit_euler",
                           kMeetsBodies = "velocity_verlet";
// omega dt from which this shows: a falling rope gains a thousandth of its energy at 105, three times its
// energy at 330; cloth that crumples on an obstacle gains four hundredths at 80.
constexpr double kMostLinear = 50;
// A step of kUsual that gains energy is taken again with kStiff, and if that gains too in parts. Energies are
// summed only where some spring may have turned by more than kTurns, rad. Swept over five random scenes that
// need it: all hold from 0.003 to 0.03, one gains at 0.1, two at 0.3; with gains of 1e-5 to 3e-2 of the
// kinetic energy allowed, two gain at 0.1.
constexpr double kTurns = 0.03;
constexpr RisingStep::Bounds kRising{.rise = 1e-3, .most_parts = 8};

double shortest_length(const SpringSchedule& schedule) {
  double shortest = HUGE_VAL;
  for (const double rest : schedule.rest) {
    if (rest > 0) shortest = std::min(shortest, rest);
  }
  return shortest;
}

ChosenMethod settle(const MassSpringDef& def, const BuildContext& context, const MassSpringField& field) {
  const IntegratorChoice choice = def.choice();
  if (!choice.name.empty()) return {choose_integrator(choice, "", field), "named by the scene"};
  if (context.meets_bodies) {
    return {choose_integrator(choice, kMeetsBodies, field),
            "the default for contact with bodies: every point responds on its own"};
  }
  const double omega = field.stiffness(field.initial_state())->omega;
  if (!(omega * context.dt > kMostLinear)) {
    return {choose_integrator(choice, kUsual, field), "the default, stable for springs of this stiffness"};
  }
  return {choose_integrator(choice, kStiff, field),
          "springs rotate within a step, and their fastest motion, " + std::to_string(omega) +
              " 1/s, is too stiff to linearise them"};
}

constexpr std::string_view kOldPosition = "mass_spring.x_old", kOldVelocity = "mass_spring.v_old";

void remember(State& s, const StepInput& in) {
  const auto copy = [&](State::Column c, std::string_view key) {
    const auto now = s.f64(c);
    std::copy(now.begin(), now.end(), in.workspace.doubles(key, now.size()).begin());
  };
  copy(Columns::position, kOldPosition);
  copy(Columns::velocity, kOldVelocity);
  in.workspace.object<bool>(kPointsAreMoved) = true;
}

}  // namespace

MassSpring::MassSpring(std::unique_ptr<const MassSpringField> field, const ChosenMethod& method,
                       const MassSpringDef& def)
    : Tabled(std::move(field), method.row, def.choice().options),
      springs_(static_cast<const MassSpringField&>(force_field())),
      colliders_(build_colliders(def.colliders)),
      radius_(0.5 * def.thickness),
      shortest_(shortest_length(springs_.schedule())),
      step_seconds_(step_seconds(def, &method.row)),
      answer_seconds_(mass_spring::answer_seconds(def)),
      idle_(idle(colliders_, springs_.network().x, radius_)),
      looks_(def.choice().name.empty() && method.row.name == kUsual),
      divides_(def.choice().name.empty() && method.row.name == kStiff && !solves_contacts()),
      rising_(springs_, kRising) {
  for (const Collider& c : colliders_.colliders()) {
    surfaces_.push_back(c.surface);
    surfaces_.back().restitution = def.restitution;
    if (def.friction) surfaces_.back().friction = *def.friction;
  }
  if (solves_contacts() || looks_ || divides_) {
    std::string on, check;
    if (solves_contacts()) {
      on = ", points on " + std::to_string(colliders_.colliders().size()) + " colliders held to them";
    }
    if (looks_)
      check = "; a step that gains energy where springs turn is taken again with " + std::string(kStiff);
    if (divides_) check = "; a step that has no solution or gains energy is taken in up to eight parts";
    add_stage("integrate",
              "advances position and velocity with " + std::string(method.row.name) + on + ": " + method.why +
                  check,
              [this](State& s, const StepInput& in) { integrate(s, in); });
  } else {
    if (!colliders_.empty()) {
      add_stage("remember", "contacts need the previous position of every point", remember);
    }
    add_integration_stage(method.why);
  }
  bound_speed();
  if (colliders_.empty()) {
    skip_stage("contacts", "there are no colliders");
  } else if (!solves_contacts()) {
    add_contact_stage();
  }
  add_stage("hands", "ends pushes whose duration is over",
            [](State& s, const StepInput& in) { Columns::kHands.count_down(s, in.h); });
  if (!def.wind) skip_stage("air", "no wind is given; set_parameter wind adds it");
  if (!(def.damping > 0)) skip_stage("viscous damping", "damping is 0");
  if (const auto crowded = def.mesh ? crowded_edge(*def.mesh) : std::nullopt) {
    skip_stage("bending at crowded edges",
               crowded->what + ": cloth is joined there and folds freely; for bending, split the mesh there");
  }
  if (!(def.internal_damping > 0)) skip_stage("internal damping", "internal_damping is 0");

  const SpringSchedule& schedule = springs_.schedule();
  for (size_t s = 0; s < schedule.a.size(); ++s) {
    drawing_.lines.push_back({schedule.a[s], schedule.b[s]});
    drawing_.line_kinds.push_back(line_kind(schedule.family[s]));
  }
  drawing_.triangles = springs_.network().triangles;
  if (def.color) drawing_.color = {def.color->x, def.color->y, def.color->z};
  if (drawing_.triangles.empty()) publish_segments();
  show();
}

void MassSpring::draw(const State&, double t, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::constant)) {
    out.parts.resize(parts().size());
    out.parts[0] = drawing_;
  }
  if (wants(wishes, Wish::obstacles)) out.obstacles = colliders_.drawn(t);
}

void MassSpring::publish_segments() {
  std::vector<uint8_t> covered(springs_.masses().size());
  for (const SpringLink& s : springs_.network().springs) {
    if (s.family != SpringFamily::structural && s.family != SpringFamily::own) continue;
    segments_.push_back({s.a, s.b});
    covered[s.a] = covered[s.b] = 1;
  }
  for (uint32_t i = 0; i < covered.size(); ++i) {
    if (!covered[i]) segments_.push_back({i, i});
  }
}

bool MassSpring::solves_contacts() const {
  return !colliders_.empty() && (integrator().name == kUsual || integrator().name == kStiff);
}

bool MassSpring::driven(const State& s) {
  return s.span<uint32_t>(Columns::air)[0] != 0 || s.rows(Columns::push_row) > 0;
}

void MassSpring::advance(const Integrator& method, State& s, const StepInput& in) const {
  if (!solves_contacts()) return method.step(force_field(), s, in, options());
  on_surfaces_.step(force_field(), method, options(), s, in,
                    driven(s) ? SurfaceContacts::Supply::some : SurfaceContacts::Supply::none);
}

void MassSpring::integrate(State& s, const StepInput& in) const {
  const bool supplied = driven(s) || std::ranges::any_of(colliders_.colliders(), [](const Collider& c) {
                          return !c.motion.at_rest();
                        });
  const RisingStep::Fast fast = [&](std::span<const double> v0, std::span<const double> v, double h) {
    const double most = kTurns * shortest_ / (2 * h);
    const auto moves = [&](double component) { return std::abs(component) > most; };
    return std::ranges::any_of(v, moves) || std::ranges::any_of(v0, moves);
  };
  const RisingStep::Step usual = [this](State& to, const StepInput& at) { advance(integrator(), to, at); };
  if (divides_) {
    const auto supply = supplied ? RisingStep::Supply::some : RisingStep::Supply::none;
    return rising_.step_in_parts(s, in, supply, fast, usual);
  }
  if (!looks_ || supplied) return advance(integrator(), s, in);
  rising_.step(
      s, in, fast, usual,
      [this](State& to, const StepInput& at) { advance(*find_integrator(kStiff), to, at); },
      [this](State& to, const StepInput& at) {
        Motion m(springs_, to, at);
        reserve_implicit_euler_sparse(m, options());
      });
}

State MassSpring::initial_state() const {
  State s = ForceSystem::initial_state();
  if (solves_contacts()) RowContacts::add_columns(s, s.rows(Columns::position));
  return s;
}

Ports MassSpring::ports() const {
  const bool together = integrator().kind == Integrator::Kind::implicit && !springs_.schedule().a.empty();
  return {.points = PointPort{.position = Columns::position,
                              .velocity = Columns::velocity,
                              .mass = std::nullopt,
                              .inverse_mass = Columns::inverse_mass,
                              .id = std::nullopt,
                              .radius = radius_},
          .solids = {springs_.network().triangles, segments_},
          .bodies = std::nullopt,
          .answers = together ? this : nullptr};
}

void MassSpring::answer(State& state, const StepInput& in, Answer which, std::span<const double> impulses,
                        std::span<double> dv) const {
  answer_implicitly(force_field(), options(), state, in, which, impulses, dv);
}

std::optional<double> MassSpring::limit(Limit which, const State& state, double h) const {
  return which == Limit::step_seconds ? std::optional(step_seconds_) : ForceSystem::limit(which, state, h);
}

Energy::Exchange MassSpring::exchange(const State& s) const {
  return driven(s) || !idle_ ? Energy::Exchange::open : Energy::Exchange::closed;
}

void MassSpring::add_contact_stage() {
  add_stage("contacts", std::to_string(colliders_.colliders().size()) + " colliders keep the points out",
            [this](State& s, const StepInput& in) {
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
            });
}

std::unique_ptr<const MassSpring> MassSpring::make(const MassSpringDef& def, const BuildContext& context) {
  auto field = std::make_unique<const MassSpringField>(def, context);
  const ChosenMethod method = settle(def, context, *field);
  return std::unique_ptr<const MassSpring>(new MassSpring(std::move(field), method, def));
}

std::unique_ptr<const System> build_mass_spring(const void* def, const BuildContext& context) {
  return MassSpring::make(*static_cast<const MassSpringDef*>(def), context);
}

}  // namespace truestep::mass_spring
