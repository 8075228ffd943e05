#include "engine/systems/flocking/flocking.h"

#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "engine/core/commands/command_checks.h"
#include "engine/core/energy.h"
#include "engine/kernels/flocking/steering.h"

namespace truestep::flocking {
namespace {

constexpr double kTurn = 6.283185307179586;
/// Streams of random numbers below those of rows.
enum Stream : uint64_t { kPlaces, kHeadings, kRows };

constexpr std::string_view kWeightNames[kWeights] = {"separation",    "alignment", "cohesion",
                                                     "goal_strength", "noise",     "coupling"};

Vec3 random_heading(bool plane, const std::array<double, 4>& u) {
  const trig::SinCos a = trig::sincos(kTurn * u[0]);
  if (plane) return {a.cos, a.sin, 0};
  const double c = 2 * u[1] - 1, s = std::sqrt(std::max(0.0, 1 - c * c));
  return {s * a.cos, c, s * a.sin};
}

}  // namespace

Vec3 Box::wrapped(Vec3 x) const {
  const auto wrap = [](double at, double from, double to) {
    const double size = to - from, in = at - size * std::floor((at - from) / size);
    // Rounding may leave a place just outside the upper side, which is the same as the lower one.
    return in >= from && in < to ? in : from;
  };
  x.x = wrap(x.x, low.x, high.x), x.y = wrap(x.y, low.y, high.y);
  if (!plane) x.z = wrap(x.z, low.z, high.z);
  return x;
}

Flocking::Flocking(const FlockingDef& def, const BuildContext& context)
    : def_(def),
      seed_(context.seed),
      boids_(boid_count(def)),
      rows_(boids_ + static_cast<size_t>(def.predators)),
      reach_(reach_of(def)),
      cos_view_(trig::cos(0.5 * def.view_angle)),
      box_{def.sides, def.center - def.half_extents, def.center + def.half_extents,
           def.space == Space::plane},
      colliders_(build_colliders(def.colliders)) {
  if (!colliders_.empty()) {
    add_stage("remember", "previous positions, for contacts",
              [this](State& s, const StepInput& in) { remember(s, in); });
  }
  switch (def.rule) {
    case Rule::reynolds:
      add_stage("steer", "separation, alignment and cohesion of " + std::to_string(boids_) + " members",
                [this](State& s, const StepInput& in) { steer(s, in); });
      break;
    case Rule::vicsek:
      add_stage("align", "mean heading and noise of " + std::to_string(boids_) + " members",
                [this](State& s, const StepInput& in) { align(s, in); });
      break;
    case Rule::cucker_smale:
      add_stage(
          "approach",
          def.decay > 0 ? "all pairs, four times a step" : "all pairs weigh the same: their mean is enough",
          [this](State& s, const StepInput& in) { approach(s, in); });
  }
  if (def.predators > 0) {
    add_stage("chase", std::to_string(def.predators) + " predators",
              [this](State& s, const StepInput& in) { chase(s, in); });
  } else {
    skip_stage("chase", "there are no predators");
  }
  if (colliders_.empty()) {
    skip_stage("contacts", "no colliders given");
  } else {
    add_stage("contacts", std::to_string(def.colliders.size()) + " colliders",
              [this](State& s, const StepInput& in) { touch(s, in); });
  }
  if (def.sides == Sides::open) skip_stage("sides", "they are open");
  show();
}

State Flocking::initial_state() const {
  State s;
  s.add({"position", "m", Scalar::f64, 3, Role::position}, rows_);
  s.add({"velocity", "m/s", Scalar::f64, 3, Role::velocity}, rows_);
  s.add({"weights", "1"}, kWeights);
  s.add({"goal", "m", Scalar::f64, 3}, 1);
  double *x = s.f64(Columns::position).data(), *v = s.f64(Columns::velocity).data();
  const Vec3 center = def_.start_center.value_or(def_.center);
  const Vec3 half = def_.start_half_extents.value_or(def_.half_extents);
  for (size_t i = 0; i < rows_; ++i) {
    const auto u = uniform4(seed_, kPlaces, i);
    Vec3 at = center + Vec3{half.x * (2 * u[0] - 1), half.y * (2 * u[1] - 1), half.z * (2 * u[2] - 1)};
    if (!def_.positions.empty() && i < boids_) at = def_.positions[i];
    // Predators come from the box's corner, not from among those they chase.
    if (i >= boids_) at = def_.center - def_.half_extents * (0.8 + 0.1 * u[0]);
    Vec3 speed = random_heading(box_.plane, uniform4(seed_, kHeadings, i));
    if (def_.heading) speed = normalized(*def_.heading);
    speed *= i < boids_ ? def_.speed : def_.predator_speed;
    if (!def_.velocities.empty() && i < boids_) speed = def_.velocities[i];
    if (box_.plane) at.z = speed.z = 0;
    // A member that would start inside a collider starts on its surface; if two overlap, on the nearer one.
    for (int k = 0; k < 4 && !colliders_.empty(); ++k) {
      const NearSurface near = colliders_.nearest(at, 0);
      if (near.distance >= kContactSlop) break;
      at += near.normal * (2 * kContactSlop - near.distance);
    }
    store3(x, i, at), store3(v, i, speed);
    hold(x, v, i);
  }
  const double weights[kWeights] = {def_.separation,    def_.alignment, def_.cohesion,
                                    def_.goal_strength, def_.noise,     def_.coupling};
  std::copy_n(weights, kWeights, s.f64(Columns::weights).data());
  if (!def_.goal) s.f64(Columns::weights)[static_cast<size_t>(Weight::goal_strength)] = 0;
  store3(s.f64(Columns::goal).data(), 0, def_.goal.value_or(Vec3{}));
  return s;
}

void Flocking::hold(double* x, double* v, size_t row) const {
  Vec3 at = load3(x, row);
  if (box_.sides == Sides::periodic) return store3(x, row, box_.wrapped(at));
  if (box_.sides == Sides::open) return;
  Vec3 u = load3(v, row);
  const auto bounce = [](double& p, double& w, double low, double high) {
    if (p < low) p = low, w = std::abs(w);
    if (p > high) p = high, w = -std::abs(w);
  };
  bounce(at.x, u.x, box_.low.x, box_.high.x), bounce(at.y, u.y, box_.low.y, box_.high.y);
  if (!box_.plane) bounce(at.z, u.z, box_.low.z, box_.high.z);
  store3(x, row, at), store3(v, row, u);
}

void Flocking::remember(State& s, const StepInput& in) const {
  auto before = in.workspace.doubles("flocking.before", 6 * rows_);
  std::copy_n(s.f64(Columns::position).data(), 3 * rows_, before.data());
  std::copy_n(s.f64(Columns::velocity).data(), 3 * rows_, before.data() + 3 * rows_);
}

void Flocking::touch(State& s, const StepInput& in) const {
  auto before = in.workspace.doubles("flocking.before", 6 * rows_);
  double *x = s.f64(Columns::position).data(), *v = s.f64(Columns::velocity).data();
  if (box_.sides == Sides::periodic) {
    // A member that passed through a periodic side came from beyond it.
    const Vec3 size = box_.high - box_.low;
    const auto beside = [](double& was, double is, double edge) {
      if (edge > 0) was += edge * std::floor((is - was) / edge + 0.5);
    };
    for (size_t i = 0; i < rows_; ++i) {
      beside(before[3 * i], x[3 * i], size.x), beside(before[3 * i + 1], x[3 * i + 1], size.y);
      if (!box_.plane) beside(before[3 * i + 2], x[3 * i + 2], size.z);
    }
  }
  colliders_.resolve({.t = in.t,
                      .h = in.h,
                      .x_old = before.first(3 * rows_),
                      .v_old = before.subspan(3 * rows_, 3 * rows_),
                      .x = s.f64(Columns::position),
                      .v = s.f64(Columns::velocity)},
                     in.workspace, in.arena);
  for (size_t i = 0; i < rows_; ++i) {
    Vec3 at = load3(x, i), u = load3(v, i);
    if (box_.plane) at.z = u.z = 0;
    // After a bounce it continues at the rule's speed.
    if (def_.rule != Rule::cucker_smale) {
      const double fastest = i < boids_ ? def_.max_speed : def_.predator_speed,
                   slowest = i < boids_ ? def_.min_speed : def_.predator_speed, size = norm(u);
      const double speed = def_.rule == Rule::vicsek ? def_.speed : std::clamp(size, slowest, fastest);
      if (speed != size) u = normalized(u, normalized(load3<double>(before.data() + 3 * rows_, i))) * speed;
    }
    store3(x, i, at), store3(v, i, u);
    hold(x, v, i);
  }
}

void Flocking::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  if (c.kind != CommandKind::set_parameter) {
    refuse_command("type", "not_possible", "members of a flock have no mass and cannot be pushed",
                   "set_parameter");
  }
  if (c.name == "goal") {
    if (!def_.goal)
      refuse_command("name", "unknown_parameter", "this flock has no goal", "goal in the scene");
    Vec3 goal = c.vector;
    if (box_.plane) goal.z = 0;
    return store3(s.f64(Columns::goal).data(), 0, goal);
  }
  const auto* at = std::find(std::begin(kWeightNames), std::end(kWeightNames), c.name);
  if (at == std::end(kWeightNames)) {
    refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set",
                   "separation, alignment, cohesion, goal_strength, noise, coupling, goal");
  }
  if (c.value < 0) refuse_command("value", "out_of_range", "the value must be at least 0");
  if (c.name == "noise" && c.value > kTurn) {
    refuse_command("value", "out_of_range", "an angle is at most a full turn", "0 to 6.283185307179586");
  }
  s.f64(Columns::weights)[static_cast<size_t>(at - std::begin(kWeightNames))] = c.value;
}

void Flocking::draw(const State&, double t, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::obstacles)) out.obstacles = colliders_.drawn(t);
  if (!wants(wishes, Wish::constant)) return;
  out.parts.resize(parts().size());
  for (PartDrawing& d : out.parts) {
    if (box_.plane) d.space = PartDrawing::Space::plane;
  }
  PartDrawing& members = out.parts[0];
  members.point_radius = def_.draw_radius;
  if (def_.color) members.color = {def_.color->x, def_.color->y, def_.color->z};
  if (out.parts.size() == 1) return;
  out.parts[1].point_radius = 4 * def_.draw_radius;
  out.parts[1].color = {0.8, 0.15, 0.1};
}

std::optional<double> Flocking::limit(Limit which, const State&, double) const {
  if (which != Limit::speed) return std::nullopt;
  double fastest = std::max({def_.max_speed, def_.speed, def_.predator_speed});
  for (const Vec3& v : def_.velocities) fastest = std::max(fastest, norm(v));
  return unexplained_speed(fastest);
}

std::unique_ptr<const System> build_flocking(const void* def, const BuildContext& context) {
  return std::make_unique<const Flocking>(*static_cast<const FlockingDef*>(def), context);
}

}  // namespace truestep::flocking
