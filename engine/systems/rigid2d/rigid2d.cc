#include "engine/systems/rigid2d/rigid2d.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/kernels/rigid/impact_limits.h"
#include "engine/systems/rigid2d/solver/finish.h"
#include "engine/systems/rigid2d/solver/substeps.h"

namespace truestep::rigid2d {

/// Scratch of a session; may be discarded at any time.
struct Rigid2d::Scratch {
  Pairs pairs;
  Solver<float> f32;
  Solver<double> f64;
  Hands hands;
  std::vector<Travel> travels;
  Sleepers sleepers;
  Substeps substeps;
  bool idle = false;
};

namespace {

constexpr std::string_view kScratch = "rigid2d";
// Fraction of the rate of substeps, for a body with two contacts. Two sweeps per substep are themselves
// a spring with (w h)^2 = 2: stiffer contacts feed every slow mode of a pile, softer ones let towers buckle
// (docs/standing.md).
constexpr double kContactHertz = 0.21;
/// Sweeps that separate deep overlaps where heavy bodies touch light ones. With one sweep, bodies that had
/// fallen into a pile stayed inside others by a quarter of their size; with four, some did.
constexpr int kUnevenSweeps = 8;
/// Steps between checks for columns that need more substeps, and for loads that need fewer.
constexpr uint64_t kStepsPerColumnLook = 4, kStepsPerLook = 16;

}  // namespace

Rigid2d::Rigid2d(const Rigid2dDef& def, const BuildContext& context)
    : model_(build_model(def)), gravity_(def.gravity.value_or(context.gravity)), dt_(context.dt) {
  settings_ = def;
  double fastest = 0;
  for (const Body& b : model_.bodies) {
    const double fall = std::sqrt(2 * norm(gravity_) * flat::norm(b.position));
    fastest = std::max({fastest, flat::norm(b.velocity), std::abs(b.angular_velocity), fall});
  }
  speed_limit_ = unexplained_speed(fastest);
  show();
  settings_.bodies.clear(), settings_.generators.clear(), settings_.joints.clear();
  add_stages();
}

void Rigid2d::add_stages() {
  const auto scratch = [](const StepInput& in) -> Scratch& { return in.workspace.object<Scratch>(kScratch); };
  add_stage("hands", "pushes, drags, and a check whether any body is awake",
            [this](State& s, const StepInput& in) { take_hands(s, in); });
  add_stage("contacts", std::to_string(model_.shapes.size()) + " shapes that may touch",
            [this, scratch](State& s, const StepInput& in) {
              if (!scratch(in).idle) find_contacts(model_, s, in.h, scratch(in).pairs, in.arena);
            });
  add_stage("substeps", "more for tall columns and for heavy bodies on light ones",
            [this, scratch](State& s, const StepInput& in) {
              if (!scratch(in).idle) choose_substeps(s, in);
            });
  add_stage("solve",
            std::to_string(settings_.substeps) + " substeps of " +
                (settings_.precision == Precision::f32 ? "f32" : "f64") + " constraints; " +
                says_slowest_bounce(restitution_speed(flat::norm(flat::flatten(gravity_)), dt_)),
            [this, scratch](State& s, const StepInput& in) {
              if (scratch(in).idle) return;
              settings_.precision == Precision::f32 ? solve<float>(s, in) : solve<double>(s, in);
            });
  add_stage("stop", "fast bodies must not pass through thin ones",
            [this, scratch](State& s, const StepInput& in) {
              Scratch& w = scratch(in);
              if (!w.idle) stop_fast_bodies(model_, s, w.pairs, w.travels, in.h, in.arena);
            });
  if (settings_.sleeping) {
    add_stage("sleep", "islands at rest are not computed",
              [this](State& s, const StepInput& in) { end_step(s, in); });
  } else {
    skip_stage("sleep", "sleeping is false");
  }
  if (model_.joints.empty()) skip_stage("joints", "the scene has none");
}

State Rigid2d::initial_state() const {
  return state_at_start(model_, gravity_);
}

Ports Rigid2d::ports() const {
  std::call_once(reached_, [this] { reach_ = std::make_unique<const FlatBodies>(model_); });
  Ports out;
  out.bodies.emplace().forms = reach_->forms();
  out.bodies->owner = reach_.get();
  return out;
}

double Rigid2d::restitution_speed(double gravity, double dt) const {
  return settings_.restitution_speed.value_or(slowest_bounce(gravity, dt));
}

int Rigid2d::substeps(const State& s) const {
  const uint32_t now = s.span<uint32_t>(columns::substeps)[0];
  return now > 0 ? static_cast<int>(now) : static_cast<int>(settings_.substeps);
}

void Rigid2d::choose_substeps(State& s, const StepInput& in) const {
  const int least = static_cast<int>(settings_.substeps), now = substeps(s);
  const double h = in.h / now;
  // Contacts with a given frequency keep it.
  const double rate = settings_.contact_hertz ? 0 : 2 * std::numbers::pi * kContactHertz / h;
  Scratch& w = in.workspace.object<Scratch>(kScratch);
  const int wanted =
      w.substeps.wanted(model_, s, w.pairs, {least, now, h, rate, in.step % kStepsPerColumnLook == 1});
  // A check removes half of the surplus, or one substep where another impact may follow soon.
  const int less = w.substeps.uneven() ? 1 : (now - wanted + 1) / 2;
  const int next = wanted < now ? now - (in.step % kStepsPerLook == 1 ? less : 0) : wanted;
  s.span<uint32_t>(columns::substeps)[0] = static_cast<uint32_t>(next);
  if (next == now) return;
  // Impulses are those of one substep.
  const double share = static_cast<double>(now) / next;
  for (float& p : s.span<float>(columns::contact_impulse)) p *= static_cast<float>(share);
  for (const auto c : {columns::joint_impulse, columns::drag_impulse}) {
    for (double& p : s.f64(c)) p *= share;
  }
  // Offsets are the yields of the contact springs.
  if (!settings_.contact_hertz) {
    for (float& offset : s.span<float>(columns::contact_offset)) offset *= static_cast<float>(share * share);
  }
}

SolverSettings Rigid2d::settings_for(double dt, int steps) const {
  SolverSettings s;
  s.steps = steps;
  s.h = dt / s.steps;
  const double rate = 1 / s.h;
  const double contact = settings_.contact_hertz.value_or(kContactHertz * rate);
  for (size_t n = 0; n <= kCrowd; ++n) {
    // The contacts under a body are together as stiff as two, however many share the load.
    const double hertz = contact * std::sqrt(2 / std::max(2.0, static_cast<double>(n)));
    s.contact[n] = soft_constraint(hertz, settings_.contact_damping_ratio, s.h);
    s.contact_fixed[n] = soft_constraint(2 * hertz, settings_.contact_damping_ratio, s.h);
  }
  s.padding = penetration_offset_rule(contact, rate, dt, 0.5);
  s.joint = soft_constraint(settings_.joint_hertz.value_or(0.25 * rate), settings_.joint_damping_ratio, s.h);
  s.push_out_speed = settings_.push_out_speed;
  return s;
}

void Rigid2d::take_hands(State& s, const StepInput& in) const {
  Scratch& w = in.workspace.object<Scratch>(kScratch);
  w.hands.forces.clear(), w.hands.drags.clear();
  const auto rest = s.f64(columns::sleep_timer);
  for (size_t k = 0; k < columns::kHands.pushes(s); ++k) {
    const UserForces::Push p = columns::kHands.push(s, k);
    const auto body = static_cast<uint32_t>(p.who);
    const Vec2 f = flat::flatten(p.force);
    const double torque = flat::cross(pose_of(s, body).q * flat::flatten(p.at), f);
    w.hands.forces.push_back(Hands::Force{body, f, torque});
    wake(s, body);
    rest[body] = 0;
  }
  for (const uint32_t body : model_.forced) {
    const Body& b = model_.bodies[body];
    if (!is_moved(model_.light[body], s.span<uint32_t>(columns::status)[body])) continue;
    // A force that turns with the body has its direction at mid-step.
    const double middle = s.f64(columns::angle)[body] + 0.5 * in.h * s.f64(columns::angular_velocity)[body];
    const trig::SinCos turn = trig::sincos(middle);
    const Vec2 f = b.force_turns ? flat::Rotation{turn.cos, turn.sin} * b.force : b.force;
    w.hands.forces.push_back({body, f, b.torque});
    rest[body] = 0;
  }
  const auto impulse = s.f64(columns::drag_impulse);
  for (size_t k = 0; k < columns::kHands.drags(s); ++k) {
    const UserForces::Drag d = columns::kHands.drag(s, k);
    const auto body = static_cast<uint32_t>(d.who);
    if (model_.bodies[body].motion != Motion::dynamic) continue;
    const Joint j = drag_joint(model_, d);
    w.hands.drags.push_back({j, Vec2{impulse[2 * k], impulse[2 * k + 1]}});
    wake(s, body);
    rest[body] = 0;
  }
  const auto status = s.span<uint32_t>(columns::status);
  const double* v = s.f64(columns::velocity).data();
  const auto spin = s.f64(columns::angular_velocity);
  w.idle = true;
  for (size_t i = 0; i < model_.count() && w.idle; ++i) {
    const Light& b = model_.light[i];
    const bool goes = b.motion == Motion::kinematic && (v[3 * i] != 0 || v[3 * i + 1] != 0 || spin[i] != 0);
    w.idle = !(is_moved(b, status[i]) || (goes && status[i] == kAwake));
  }
}

template <class T>
void Rigid2d::solve(State& s, const StepInput& in) const {
  Scratch& w = in.workspace.object<Scratch>(kScratch);
  Solver<T>* solver;
  if constexpr (sizeof(T) == 4) {
    solver = &w.f32;
  } else {
    solver = &w.f64;
  }
  const auto g = s.f64(columns::parameters);
  SolverSettings settings = settings_for(in.h, substeps(s));
  settings.restitution_speed = restitution_speed(flat::norm(Vec2{g[0], g[1]}), in.h);
  if (w.substeps.uneven()) settings.push_sweeps = kUnevenSweeps;
  solver->solve(model_, s, w.pairs, w.hands, settings, in.arena);
  solver->store_contacts(model_, w.pairs, settings.padding, s);
  const auto impulse = s.f64(columns::drag_impulse);
  size_t next = 0;
  for (size_t k = 0; k < s.rows(columns::drag_body); ++k) {
    const uint32_t body = s.span<uint32_t>(columns::drag_body)[k];
    if (model_.bodies[body].motion != Motion::dynamic) continue;
    const Vec2 p = w.hands.drags[next++].impulse;
    impulse[2 * k] = p.x, impulse[2 * k + 1] = p.y;
  }
  w.travels.clear();
  for (const uint32_t body : solver->movers()) {
    const auto m = solver->moved(body);
    w.travels.push_back({body, m.shift, m.angle});
  }
  const auto earlier = [](const Travel& a, const Travel& b) { return a.body < b.body; };
  if (!std::is_sorted(w.travels.begin(), w.travels.end(), earlier)) {
    std::sort(w.travels.begin(), w.travels.end(), earlier);
  }

  columns::kHands.count_down(s, in.h);
}

void Rigid2d::end_step(State& s, const StepInput& in) const {
  Scratch& w = in.workspace.object<Scratch>(kScratch);
  if (w.idle) return;
  fall_asleep(model_, s, w.pairs, {settings_.sleep_speed, settings_.sleep_time}, in.h, w.sleepers);
}

void Rigid2d::wake(State& s, uint32_t body) const {
  if (!is_asleep(model_.light[body], s.span<uint32_t>(columns::status)[body])) return;
  std::vector<uint8_t> seeds(model_.count());
  seeds[body] = 1;
  wake_islands(model_, s, seeds);
}

std::unique_ptr<const System> build_rigid2d(const void* def, const BuildContext& context) {
  return std::make_unique<const Rigid2d>(*static_cast<const Rigid2dDef*>(def), context);
}

Cost rigid2d_cost(const void* def) {
  const auto& d = *static_cast<const Rigid2dDef*>(def);
  const Counts n = counts(d);
  // Measured on a pyramid of 5,050 boxes and a grid of 19,800 joints with four substeps.
  const double steps = static_cast<double>(d.substeps) / 4;
  const double wide = d.precision == Precision::f64 ? 1.5 : 1;
  // A rotating kinematic body keeps a heap moving: new pairs in every step, and fast ones.
  const bool stirred = std::ranges::any_of(
      d.bodies, [](const BodyDef& b) { return b.motion == Motion::kinematic && b.angular_velocity != 0; });
  // Joined bodies have fewer contacts.
  const double touching =
      (stirred ? 3 : 1) * (3e-7 + 5e-7 * steps) * std::max(n.moving_shapes - 0.5 * n.joints, 0.0);
  const double joined = 5e-7 * steps * n.joints;
  return {.state_bytes = 400 * n.bodies + 120 * n.shapes + 60 * n.joints,
          .workspace_bytes = 400 * n.bodies + 300 * n.shapes + 1200 * n.moving_shapes + 900 * n.joints,
          .elements = n.bodies + n.shapes + n.joints,
          .seconds_per_step = 1e-6 + 1e-7 * n.bodies + 3e-8 * n.shapes + wide * (touching + joined)};
}

}  // namespace truestep::rigid2d
