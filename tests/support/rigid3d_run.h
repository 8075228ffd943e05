// A rigid3d system on its own: build from a def, step, look.
#pragma once
#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep::testing {

struct RigidRun {
  explicit RigidRun(const rigid3d::Rigid3dDef& def, double step = 1.0 / 60, int threads = 1,
                    Vec3 gravity = {0, -9.81, 0})
      : h(step), arena(threads) {
    BuildContext context;
    context.id = "r";
    context.gravity = gravity;
    context.dt = step;
    context.seed = 7;
    system = std::make_unique<const rigid3d::Rigid3d>(def, context);
    state = system->initial_state();
  }
  double t() const { return static_cast<double>(step) * h; }
  void run(uint64_t steps) {
    for (uint64_t k = 0; k < steps; ++k, ++step) system->step(state, {t(), h, step, workspace, arena});
  }
  void seconds(double s) { run(static_cast<uint64_t>(s / h + 0.5)); }
  size_t count() const { return state.rows(rigid3d::columns::position); }
  Vec3 x(size_t i) const { return load3(state.f64(rigid3d::columns::position).data(), i); }
  Vec3 v(size_t i) const { return load3(state.f64(rigid3d::columns::velocity).data(), i); }
  Vec3 w(size_t i) const { return load3(state.f64(rigid3d::columns::angular_velocity).data(), i); }
  Quat q(size_t i) const { return rigid3d::load_quat(state.f64(rigid3d::columns::orientation).data(), i); }
  double observed(const char* name) const {
    Observables out;
    system->observe(state, t(), out);
    return out.find(name).value();
  }
  void apply(const Command& c) { system->apply(state, c); }

  double h;
  ThreadArena arena;
  std::unique_ptr<const rigid3d::Rigid3d> system;
  State state;
  Workspace workspace;
  uint64_t step = 0;
};

inline rigid3d::PlaneBodyDef ground() {
  rigid3d::PlaneBodyDef d;
  d.motion = rigid3d::BodyDef::Motion::fixed;
  return d;
}
inline rigid3d::BoxBodyDef box(Vec3 half, Vec3 at) {
  rigid3d::BoxBodyDef d;
  d.half_extents = half, d.position = at;
  return d;
}
inline rigid3d::SphereBodyDef ball(double radius, Vec3 at) {
  rigid3d::SphereBodyDef d;
  d.radius = radius, d.position = at;
  return d;
}

}  // namespace truestep::testing
