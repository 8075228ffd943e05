// A rigid3d system on its own: build from a def, step, look.
#pragma once
#include "engine/systems/rigid3d/rigid3d.h"
#include "tests/support/runs/system_run.h"

namespace truestep::testing {

struct RigidRun : testing_rig::SystemRun<std::unique_ptr<const rigid3d::Rigid3d>> {
  explicit RigidRun(const rigid3d::Rigid3dDef& def, double step = 1.0 / 60, int threads = 1,
                    Vec3 gravity = {0, -9.81, 0})
      : SystemRun(
            [&] {
              return std::make_unique<const rigid3d::Rigid3d>(
                  def, BuildContext{.id = "r", .gravity = gravity, .dt = step, .seed = 7});
            },
            step, threads) {}
  void run(uint64_t count) { step(count); }
  size_t count() const { return state.rows(rigid3d::columns::position); }
  Vec3 x(size_t i) const { return load3(state.f64(rigid3d::columns::position).data(), i); }
  Vec3 v(size_t i) const { return load3(state.f64(rigid3d::columns::velocity).data(), i); }
  Vec3 w(size_t i) const { return load3(state.f64(rigid3d::columns::angular_velocity).data(), i); }
  Quat q(size_t i) const { return rigid3d::load_quat(state.f64(rigid3d::columns::orientation).data(), i); }
  double observed(const char* name) const { return observe(name); }
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
