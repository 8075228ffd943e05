// One rigid scene on one engine: build from a def, step, look. For comparing engines.
#pragma once
#include <cmath>

#include "engine/reference/engines.h"
#include "engine/systems/rigid2d/rigid2d_def.h"
#include "engine/systems/rigid3d/rigid3d_def.h"
#include "tests/support/runs/system_run.h"

namespace truestep::testing {

struct EngineRun : testing_rig::SystemRun<std::unique_ptr<const System>> {
  EngineRun(std::unique_ptr<const System> built, double dt)
      : SystemRun([&] { return std::move(built); }, dt) {}

  void run(uint64_t count) { step(count); }
  const double* column(const char* name) const { return state.f64(state.at(name)).data(); }
  size_t count() const { return state.rows(state.at("position")); }
  Vec3 x(size_t i) const { return load3(column("position"), i); }
  Vec3 v(size_t i) const { return load3(column("velocity"), i); }
  double angle(size_t i) const { return column("angle")[i]; }
  double observed(const char* name) const { return observe(name); }
};

inline BuildContext engine_context(double step) {
  BuildContext c;
  c.id = "r", c.dt = step, c.seed = 7;
  return c;
}
inline EngineRun ours(rigid3d::Rigid3dDef def, double step = 1.0 / 60) {
  return {build_rigid3d_engine(&def, engine_context(step)), step};
}
inline EngineRun theirs(rigid3d::Rigid3dDef def, double step = 1.0 / 60) {
  def.engine = rigid3d::Rigid3dDef::Engine::bullet;
  return {build_rigid3d_engine(&def, engine_context(step)), step};
}
inline EngineRun ours(rigid2d::Rigid2dDef def, double step = 1.0 / 60) {
  return {build_rigid2d_engine(&def, engine_context(step)), step};
}
inline EngineRun theirs(rigid2d::Rigid2dDef def, double step = 1.0 / 60) {
  def.engine = rigid2d::Rigid2dDef::Engine::box2d;
  return {build_rigid2d_engine(&def, engine_context(step)), step};
}

}  // namespace truestep::testing
