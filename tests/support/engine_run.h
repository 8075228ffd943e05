// One rigid scene on one engine: build from a def, step, look. For comparing engines.
#pragma once
#include <cmath>

#include "engine/reference/engines.h"
#include "engine/systems/rigid2d/rigid2d_def.h"
#include "engine/systems/rigid3d/rigid3d_def.h"

namespace truestep::testing {

struct EngineRun {
  EngineRun(std::unique_ptr<const System> built, double step)
      : h(step), system(std::move(built)), state(system->initial_state()) {}

  double t() const { return static_cast<double>(step) * h; }
  void run(uint64_t steps) {
    for (uint64_t k = 0; k < steps; ++k, ++step) system->step(state, {t(), h, step, workspace, arena});
  }
  void seconds(double s) { run(static_cast<uint64_t>(std::llround(s / h))); }
  const double* column(const char* name) const { return state.f64(state.at(name)).data(); }
  size_t count() const { return state.rows(state.at("position")); }
  Vec3 x(size_t i) const { return load3(column("position"), i); }
  Vec3 v(size_t i) const { return load3(column("velocity"), i); }
  double angle(size_t i) const { return column("angle")[i]; }
  double observed(const char* name) const {
    Observables out;
    system->observe(state, t(), out);
    return out.find(name).value();
  }

  double h;
  ThreadArena arena{1};
  std::unique_ptr<const System> system;
  State state;
  Workspace workspace;
  uint64_t step = 0;
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
