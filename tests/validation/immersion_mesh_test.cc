// A box held in still water, given as a box and as a mesh of triangles: the pressure on both is the same.
#include <cmath>

#include "engine/geometry/solid.h"
#include "tests/unit/sph_rig.h"

namespace truestep {
namespace {

using testing_rig::SphRun;

Solid mesh_of_box(const Vec3& half) {
  std::vector<Vec3> x;
  for (int k = 0; k < 8; ++k) {
    x.push_back({(k & 1 ? 1 : -1) * half.x, (k & 2 ? 1 : -1) * half.y, (k & 4 ? 1 : -1) * half.z});
  }
  return mesh_solid(x, {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                        2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5});
}

/// N, mean buoyancy over half a second of a box of a tenth of a metre held in still water.
double lift(const Solid& solid) {
  sph::SphDef d;
  d.high = {0.4, 0.4, 0.4}, d.spacing = 0.025;
  d.bodies = {{.center = {0.2, 0.125, 0.2}, .half_extents = {0.2, 0.125, 0.2}}};
  d.hollows = {{.center = {0.2, 0.1, 0.2}, .half_extents = {0.05, 0.05, 0.05}}};
  SphRun run(d, 1.0 / 60, {0, -9.81, 0});
  double sum = 0;
  for (int k = 0; k < 60; ++k) {
    ImmersedBody held{.solid = &solid, .place = {0.2, 0.1, 0.2}};
    run.step(1, {&held, 1});
    if (k >= 30) sum += held.impulse.y;
  }
  return sum / (30 * run.h);
}

// Case fluid.hydrostatic on a body: the case's 2 % of the weight of the displaced water, and meshes within 1
// % of the box, whose particles see other rounding after a second.
TEST(ImmersionMesh, StillWaterPressesOnAMeshAsOnABox) {
  const Vec3 half{0.05, 0.05, 0.05};
  const double weight = 9.81 * 1000 * 1e-3;
  const double box = lift(box_solid(half)), mesh = lift(mesh_of_box(half));
  EXPECT_NEAR(box, weight, 0.02 * weight);
  EXPECT_NEAR(mesh, box, 0.01 * weight);
  EXPECT_LT(lift(mesh_of_box({0.05, 0.04, 0.05})), 0.9 * weight) << "control: a lower box";
}

}  // namespace
}  // namespace truestep
