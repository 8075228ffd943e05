// A particles system on its own: build from a def, step, look.
#pragma once
#include "engine/systems/particles/particles.h"
#include "tests/support/runs/system_run.h"

namespace truestep::testing {

struct ParticlesRun : testing_rig::SystemRun<std::unique_ptr<const particles::Particles>> {
  explicit ParticlesRun(const particles::ParticlesDef& def, double step = 1.0 / 240, int threads = 1,
                        uint64_t seed = 7)
      : SystemRun(
            [&] {
              return particles::Particles::make(
                  def, BuildContext{.id = "p", .gravity = {0, -9.81, 0}, .dt = step, .seed = seed});
            },
            step, threads) {}
  void run(uint64_t count) { step(count); }
  size_t count() const { return state.rows(particles::columns::position); }
  Vec3 x(size_t i) const { return load3(state.f64(particles::columns::position).data(), i); }
  Vec3 v(size_t i) const { return load3(state.f64(particles::columns::velocity).data(), i); }
  double observed(const char* name) const { return observe(name); }
};

}  // namespace truestep::testing
