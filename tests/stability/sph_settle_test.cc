// Pools that settle before time starts: case fluid.hydrostatic asks that nothing in still water moves faster
// than 1 % of sqrt(g H).
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;

constexpr double kDepth = 0.5;

/// Half a metre of water from wall to wall, `rows` deep, at defaults but for these.
SphDef pool(int dimension, int rows, Method solver, double settle) {
  SphDef d;
  d.dimension = dimension, d.spacing = kDepth / rows, d.solver = solver, d.settle = settle;
  const double wide = dimension == 2 ? 1 : 0.5;
  d.high = {wide, 1, wide};
  d.bodies = {{.center = {wide / 2, kDepth / 2, wide / 2}, .half_extents = {wide / 2, kDepth / 2, wide / 2}}};
  if (dimension == 2) d.bodies[0].center.z = 0;
  return d;
}

/// Of any particle at any step of this many seconds, over sqrt(g H).
double fastest(const SphDef& d, double seconds) {
  SphRun run(d, 1.0 / 60, {0, -9.81, 0});
  double most = 0;
  for (int k = 0; k < 60 * seconds; ++k) run.step(), most = std::max(most, run.observe("speed.max"));
  return most / std::sqrt(9.81 * kDepth);
}

// The case's 1 %, from the first step on; most pools that have settled for 20 s are ten times as still.
TEST(SphSettle, EveryParticleOfAPoolIsStillFromTheStart) {
  EXPECT_LT(fastest(pool(2, 20, Method::dfsph, 20), 10), 0.01);
  EXPECT_LT(fastest(pool(3, 8, Method::dfsph, 20), 10), 0.01);
  EXPECT_LT(fastest(pool(2, 20, Method::pbf, 20), 10), 0.01);
  EXPECT_LT(fastest(pool(3, 8, Method::pbf, 20), 10), 0.01);
  EXPECT_LT(fastest(pool(2, 10, Method::wcsph, 20), 5), 0.01);
  for (const Method solver : {Method::dfsph, Method::wcsph, Method::pbf}) {
    EXPECT_GT(fastest(pool(2, 10, solver, 0), 2), 0.02)
        << "control: on its lattice " << static_cast<int>(solver);
  }
}

}  // namespace
}  // namespace truestep::sph
