#include "engine/systems/rigid3d/rigid3d.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/systems/rigid3d/forces.h"

namespace truestep::rigid3d {

namespace {

/// Number of bodies that may be spawned in addition to the scene's.
constexpr size_t kSpare = 10'000;
/// kg m^2, of a body that never rotates, for couplings: these also multiply by moments, which must be finite.
constexpr Vec3 kNeverTurned{1e300, 1e300, 1e300};
}  // namespace

Rigid3d::Rigid3d(const Rigid3dDef& def, const BuildContext& context)
    : bodies_(build_bodies(def, context.seed)),
      joints_(build_joints(def, bodies_)),
      restitution_speed_(def.restitution_speed),
      precision_(def.precision),
      gravity_(def.gravity.value_or(context.gravity)),
      sleep_speed_(def.sleep_speed),
      sleep_time_(def.sleep_time),
      dt_(context.dt),
      most_bodies_(bodies_.starts.size() + kSpare) {
  settings_ = {static_cast<int>(def.substeps), 0, def.push_out_speed, def.contact_hertz,
               def.contact_damping_ratio};
  double fastest = 0;
  for (const BodyStart& b : bodies_.starts)
    fastest = std::max({fastest, norm(b.velocity), norm(b.angular_velocity),
                        std::sqrt(2 * norm(gravity_) * norm(b.pose.position))});
  speed_limit_ = unexplained_speed(fastest);
  for (const BodyKind& k : bodies_.kinds)
    forms_.push_back({k.sensor ? nullptr : &k.solid, k.moved_by_forces() ? k.mass : 0,
                      k.fixed_rotation ? kNeverTurned : k.moments});
  name_joints();
  show();
  // Everything may fall asleep within a step.
  const auto awake = [this](void (Rigid3d::*run)(State&, const StepInput&) const) {
    return [this, run](State& s, const StepInput& in) {
      if (!all_asleep(s)) (this->*run)(s, in);
    };
  };
  add_stage("forces", "gravity and pushes", awake(&Rigid3d::apply_forces));
  add_stage("contacts", "finds which bodies touch, and where", awake(&Rigid3d::find_contacts));
  add_stage("solve",
            "bodies in contact, in substeps; " + says_slowest_bounce(restitution_speed(gravity_, context.dt)),
            awake(&Rigid3d::solve));
  add_stage("integrate_free", "bodies without contacts", awake(&Rigid3d::integrate_free));
  add_stage("fast bodies", "none passes through another within a step", awake(&Rigid3d::stop_fast_bodies));
  if (def.sleeping) {
    add_stage("sleep", "groups of bodies at rest are not computed", awake(&Rigid3d::update_sleeping));
  } else {
    skip_stage("sleep", "sleeping is false");
  }
  add_stage("substeps", "more in the next steps for tall columns", awake(&Rigid3d::choose_substeps));
}

State Rigid3d::initial_state() const {
  return rigid3d_at_start(bodies_, joints_, gravity_);
}

Ports Rigid3d::ports() const {
  Ports out;
  out.bodies = BodyPort{.position = columns::position,
                        .velocity = columns::velocity,
                        .orientation = columns::orientation,
                        .angular_velocity = columns::angular_velocity,
                        .form = columns::kind,
                        .id = columns::id,
                        .gravity = columns::gravity,
                        .forms = forms_,
                        .owner = this};
  return out;
}

void Rigid3d::wake(State& s, size_t row) const {
  wake_body(s, row, bodies_.kinds);
}

Rigid3d::Scratch& Rigid3d::scratch(const StepInput& in) {
  return in.workspace.object<Scratch>("rigid3d");
}

bool Rigid3d::all_asleep(const State& s) const {
  const auto asleep = s.span<uint32_t>(columns::asleep);
  const auto kind = s.span<uint32_t>(columns::kind);
  const double *v = s.f64(columns::velocity).data(), *w = s.f64(columns::angular_velocity).data(),
               *rested = s.f64(columns::sleep_timer).data();
  for (size_t i = 0; i < kind.size(); ++i) {
    const BodyKind& k = bodies_.kinds[kind[i]];
    const bool given = !k.moved_by_forces() || is_led(rested, i);
    if (!given && !asleep[i]) return false;
    if (given && k.motion != BodyDef::Motion::fixed && (load3(v, i) != Vec3{} || load3(w, i) != Vec3{}))
      return false;
  }
  return true;
}

void Rigid3d::apply_forces(State& s, const StepInput& in) const {
  collect_forces(s, bodies_.kinds, in.h, scratch(in).change, scratch(in).twist);
}

int Rigid3d::substeps(const State& s, double h) const {
  // A state from outside may hold anything.
  const double most = BucklingWatch::kMostTimes * settings_.substeps;
  return static_cast<int>(std::lround(std::clamp(h / s.f64(columns::substep)[0], 1.0, most)));
}

double Rigid3d::restitution_speed(const Vec3& gravity, double dt) const {
  return restitution_speed_.value_or(slowest_bounce(norm(gravity), dt));
}

std::unique_ptr<const System> build_rigid3d(const void* def, const BuildContext& context) {
  return std::make_unique<Rigid3d>(*static_cast<const Rigid3dDef*>(def), context);
}

}  // namespace truestep::rigid3d
