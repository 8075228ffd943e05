// The leapfrog in one pass has the bits of the general one, which pair forces of strength 0 force to be used.
#include <gtest/gtest.h>

#include "tests/support/runs/particles_run.h"

namespace truestep {
using namespace particles;
namespace {

std::vector<double> bits(const ParticlesDef& d, int threads) {
  testing::ParticlesRun r(d, 0.01, threads);
  r.run(20);
  const auto x = r.state.f64(particles::columns::position), v = r.state.f64(particles::columns::velocity);
  std::vector<double> out(x.begin(), x.end());
  out.insert(out.end(), v.begin(), v.end());
  return out;
}

TEST(ParticlesOnePass, HasTheBitsOfTheGeneralLeapfrog) {
  for (const double drag : {0.0, 0.2}) {
    ParticlesDef d;
    FillDef f;
    f.count = 3001, f.speed_spread = 3;  // neither whole blocks nor whole groups of 256
    d.fill = {f};
    d.linear_drag = drag, d.wind = {1, 0, 0};
    d.attractors = {{{0.3, 2, 0}, 4, 0.1}};
    d.expression = ExpressionDef{};
    d.expression->fx = "sin(3*t)*y";
    ParticlesDef general = d;
    general.pair_forces = {SoftRepulsionDef{.stiffness = 0, .cutoff = 1e-3}};
    const auto one = bits(d, 1);
    EXPECT_EQ(one, bits(general, 1));
    EXPECT_EQ(one, bits(d, 3));
    d.linear_drag = drag + 1e-9;  // the control: a little more drag is seen
    EXPECT_NE(one, bits(d, 1));
  }
}

}  // namespace
}  // namespace truestep
