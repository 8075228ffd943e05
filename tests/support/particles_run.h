// A particles system on its own: build from a def, step, look.
#pragma once
#include "engine/systems/particles/particles.h"

namespace truestep::testing {

struct ParticlesRun {
  explicit ParticlesRun(const particles::ParticlesDef& def, double step = 1.0 / 240, int threads = 1,
                        uint64_t seed = 7)
      : h(step), arena(threads) {
    BuildContext context;
    context.id = "p";
    context.gravity = {0, -9.81, 0};
    context.dt = step;
    context.seed = seed;
    system = particles::Particles::make(def, context);
    state = system->initial_state();
  }
  double t() const { return static_cast<double>(step) * h; }
  void run(uint64_t steps) {
    for (uint64_t k = 0; k < steps; ++k, ++step) system->step(state, {t(), h, step, workspace, arena});
  }
  size_t count() const { return state.rows(particles::columns::position); }
  Vec3 x(size_t i) const { return load3(state.f64(particles::columns::position).data(), i); }
  Vec3 v(size_t i) const { return load3(state.f64(particles::columns::velocity).data(), i); }
  double observed(const char* name) const {
    Observables out;
    system->observe(state, t(), out);
    return out.find(name).value();
  }

  double h;
  ThreadArena arena;
  std::unique_ptr<const particles::Particles> system;
  State state;
  Workspace workspace;
  uint64_t step = 0;
};

}  // namespace truestep::testing
