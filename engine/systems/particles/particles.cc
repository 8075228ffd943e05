#include "engine/systems/particles/particles.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/systems/particles/boris.h"

namespace truestep::particles {

namespace {

constexpr std::string_view kDefaultIntegrator = "leapfrog";

/// Whether no particle acts on another.
bool each_alone(const ParticlesDef& d) {
  return d.pair_forces.empty() && !d.coulomb && d.springs.empty();
}

/// Error "scene_invalid" when the method cannot handle the particles.
const Integrator& checked_boris(const ParticlesDef& def) {
  const auto why = boris_refusal(def);
  if (!why) return boris();
  throw Error(
      "scene_invalid", "integrator boris: " + *why,
      {"/integrator", "unsuitable_integrator", *why, "\"boris\"", "leapfrog, rk4 and others", "", ""});
}

}  // namespace

Particles::Particles(std::unique_ptr<const ParticlesField> field, const ChosenMethod& method,
                     const ParticlesDef& def, uint64_t seed)
    : Tabled(std::move(field), method.row, def.choice().options),
      particles_(static_cast<const ParticlesField&>(force_field())),
      seed_(seed) {
  show();
  plan_stages(method.why);
}

std::unique_ptr<const Particles> Particles::make(const ParticlesDef& def, const BuildContext& context) {
  auto field = std::make_unique<const ParticlesField>(def, context.gravity, context.seed);
  const ChosenMethod method =
      def.integrator == kBorisName
          ? ChosenMethod{checked_boris(def), "named by the scene"}
          : settle_method(def.choice(), {.usual = kDefaultIntegrator}, *field, context.dt);
  return std::unique_ptr<const Particles>(new Particles(std::move(field), method, def, context.seed));
}

void Particles::plan_stages(const std::string& why_this_method) {
  const ParticlesDef& d = particles_.def();
  if (!d.colliders.empty()) {
    add_stage("remember", "contacts need the start of the step",
              [this](State& s, const StepInput& in) { remember(s, in); });
  }
  if (integrator().name == kDefaultIntegrator && each_alone(d)) {
    add_stage("integrate",
              "advances position and velocity with leapfrog in one pass, each particle on its own" +
                  (why_this_method.empty() ? "" : ": " + why_this_method),
              [this](State& s, const StepInput& in) {
                // Pushed or dragged particles need the general step.
                if (particles_.each_alone(s)) return particles_.leapfrog_alone(s, in);
                integrator().step(particles_, s, in, options());
              });
  } else {
    add_integration_stage(why_this_method);
  }
  if (!d.colliders.empty()) {
    add_stage("contacts", std::to_string(d.colliders.size()) + " colliders",
              [this](State& s, const StepInput& in) { collide(s, in); });
  } else {
    skip_stage("contacts", "no colliders given");
  }
  const bool ends = d.any_regions() || std::any_of(d.emitters.begin(), d.emitters.end(),
                                                   [](auto& e) { return e.lifetime.has_value(); });
  if (ends) {
    add_stage("removal", "lifetimes or kill regions",
              [this](State& s, const StepInput& in) { end_lives(s, in); });
  } else {
    skip_stage("removal", "no lifetimes and no kill regions given");
  }
  add_stage("clock", "advances the state's time and ends pushes whose duration is over",
            [](State& s, const StepInput& in) {
              s.f64(columns::time)[0] = in.t + in.h;
              columns::kHands.count_down(s, in.h, [&](uint64_t id) { return row_of(s, id).has_value(); });
            });
  if (!d.emitters.empty()) {
    add_stage("births", std::to_string(d.emitters.size()) + " emitters",
              [this](State& s, const StepInput& in) { emit(s, in); });
  } else {
    skip_stage("births", "no emitters given");
  }
  if (d.linear_drag == 0 && d.quadratic_drag == 0) skip_stage("drag", "both coefficients are 0");
  if (d.attractors.empty()) skip_stage("point gravity", "no attractors given");
  if (d.pair_forces.empty()) skip_stage("pair forces", "none given: no neighbour search");
  if (d.springs.empty()) skip_stage("springs", "none given");
  if (!d.propulsion) skip_stage("propulsion", "none given");
  if (!d.expression) skip_stage("expression", "none given");
  if (!d.coulomb) skip_stage("electrostatics", "no coulomb given");
  if (d.charge == 0 && d.charges.empty()) skip_stage("Lorentz force", "charge is 0");
}

State Particles::initial_state() const {
  State s = ForceSystem::initial_state();
  // The integrator's per-particle columns grow with the particles.
  for (State::Column c = 0; c < s.columns(); ++c) {
    if (s.info(c).name.starts_with("integrator.") && s.rows(c) != 1) s.reserve(c, particles_.capacity());
  }
  return s;
}

void Particles::draw(const State& s, double time, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::obstacles)) out.obstacles = particles_.colliders().drawn(time);
  const ParticlesDef& d = particles_.def();
  // Lines refer to rows, which move only when particles die.
  if (!d.springs.empty()) out.version = static_cast<uint32_t>(1 + counter(s, Counter::killed));
  if (!wants(wishes, Wish::constant)) return;
  PartDrawing& t = out.parts.emplace_back();
  const auto rows = s.span<uint32_t>(columns::spring_rows);
  for (size_t k = 0; k < rows.size(); k += 2) t.lines.push_back({rows[k], rows[k + 1]});
  t.point_radius = std::max(d.draw_radius, d.radius);
  if (d.color) t.color = {d.color->x, d.color->y, d.color->z};
}

Energy::Exchange Particles::exchange(const State& s) const {
  const ParticlesDef& d = particles_.def();
  const bool changing = !d.emitters.empty() || d.any_regions();
  const bool blown =
      vector_parameter(s, Parameter::wind) != Vec3{} &&
      (parameter(s, Parameter::linear_drag) != 0 || parameter(s, Parameter::quadratic_drag) != 0);
  const bool driven =
      d.expression || d.propulsion || blown || !particles_.colliders().empty() || columns::kHands.any(s);
  return changing || driven ? Energy::Exchange::open : Energy::Exchange::closed;
}

Ports Particles::ports() const {
  Ports ports;
  ports.points = PointPort{columns::position, columns::velocity, columns::mass,
                           std::nullopt,      columns::id,       particles_.def().radius};
  ports.solids.balls = PublishedSolids::Balls::every_point;
  return ports;
}

namespace {

/// Neighbours within the largest cutoff of a particle, from the density at t = 0: an estimate for admission.
double expected_neighbours(const ParticlesDef& d, double count) {
  double reach = 0;
  for (const PairForceDef& p : d.pair_forces) {
    reach = std::max(reach, std::visit([](const auto& law) { return law.cutoff; }, p));
  }
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;
  const auto cover = [&](const Vec3& a, const Vec3& b) {
    low = {std::min(low.x, a.x), std::min(low.y, a.y), std::min(low.z, a.z)};
    high = {std::max(high.x, b.x), std::max(high.y, b.y), std::max(high.z, b.z)};
  };
  for (const Vec3& x : d.positions) cover(x, x);
  for (const FillDef& f : d.fill) {
    const Vec3 half = f.shape == FillDef::Shape::box ? f.half_extents : Vec3{f.radius, f.radius, f.radius};
    cover(f.center - half, f.center + half);
  }
  // A flat or empty region counts as thick as the reach.
  const auto extent = [reach](double a, double b) { return std::max(b - a, reach); };
  const double volume = extent(low.x, high.x) * extent(low.y, high.y) * extent(low.z, high.z);
  return std::min(count, count * 4.2 * reach * reach * reach / volume);
}

}  // namespace

std::unique_ptr<const System> build_particles(const void* def, const BuildContext& context) {
  return Particles::make(*static_cast<const ParticlesDef*>(def), context);
}

Cost particles_cost(const void* def) {
  const auto& d = *static_cast<const ParticlesDef*>(def);
  const auto n = static_cast<double>(largest_count(d));
  Cost c;
  c.state_bytes = n * 80 + static_cast<double>(d.springs.size()) * 32;
  // Two accelerations or velocities and the arrays of multi-stage methods, unless one pass or one kick
  // suffices; the step's initial state if there are contacts.
  const bool usual = d.integrator.empty() || d.integrator == kDefaultIntegrator;
  const double stages = d.integrator == kBorisName ? 24
                        : usual && each_alone(d)   ? 14
                                                   : 70 + (d.expression ? 80 : 0);
  c.workspace_bytes = n * (stages + (d.colliders.empty() ? 0 : 50));
  const bool tree = d.coulomb && by_tree(*d.coulomb, largest_count(d));
  if (d.coulomb)  // the tree with its results for either sign; sums over all pairs, in strips
    c.workspace_bytes += n * (tree ? 330 : 60 + 24 * std::clamp(n / 256, 1.0, 8.0));
  c.elements = n + static_cast<double>(d.springs.size());
  const double pairs = d.pair_forces.empty() ? 0
                                             : 5e-7 + 1e-8 * expected_neighbours(d, n) *
                                                          static_cast<double>(d.pair_forces.size());
  const double charged = tree ? 1.5e-6 : d.coulomb ? 5e-10 * n : 0;  // each pair once
  const double own = d.expression ? 6e-8 : 0;
  // Measured with every particle near the colliders; the walls of a container are near most particles.
  double walls = 0;
  for (const ColliderDef& any : d.colliders) {
    const auto* box = std::get_if<BoxColliderDef>(&any);
    walls += box && box->container ? 1.3e-7 : 4e-8;
  }
  c.seconds_per_step =
      8e-7 + n * (6e-9 + 3e-9 * static_cast<double>(d.attractors.size()) + walls + pairs + own + charged) +
      1e-8 * static_cast<double>(d.springs.size());
  return c;
}

}  // namespace truestep::particles
