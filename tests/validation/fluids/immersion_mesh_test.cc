// A box held in still water, given as a box and as a mesh of triangles: the pressure on both is the same.
#include <cmath>

#include "tests/unit/fluids/sph_rig.h"
#include "tests/unit/scene/mesh_box_rig.h"

namespace truestep {
namespace {

using testing_rig::mesh_of_box;
using testing_rig::SphRun;

/// N, mean over half a second of the lift of still water on a box of a fifth of a metre, eight spacings, that
/// is held in it. The water comes to rest about it in a second.
double lift(const Solid& solid) {
  sph::SphDef d;
  d.high = {0.45, 0.5, 0.45}, d.spacing = 0.025;
  d.bodies = {{.center = {0.225, 0.2, 0.225}, .half_extents = {0.225, 0.2, 0.225}}};
  const Vec3 place{0.225, 0.2, 0.225};
  d.hollows = {{.center = place, .half_extents = {0.1, 0.1, 0.1}}};
  SphRun run(d, 1.0 / 60, {0, -9.81, 0});
  double sum = 0;
  for (int k = 0; k < 90; ++k) {
    ImmersedBody held{.solid = &solid, .place = place};
    run.step(1, {&held, 1});
    if (k >= 60) sum += held.impulse.y;
  }
  return sum / (30 * run.h);
}

// Case fluid.hydrostatic on a body: the case's 2 % of the weight of the displaced water, and meshes within 1
// % of the box, whose particles see other rounding after a second.
TEST(ImmersionMesh, StillWaterPressesOnAMeshAsOnABox) {
  const Vec3 half{0.1, 0.1, 0.1};
  const double weight = 9.81 * 1000 * 8e-3;
  const double box = lift(box_solid(half)), mesh = lift(mesh_of_box(half));
  EXPECT_NEAR(box, weight, 0.02 * weight);
  EXPECT_NEAR(mesh, box, 0.01 * weight);
  EXPECT_LT(lift(mesh_of_box({0.1, 0.08, 0.1})), 0.9 * weight) << "control: a lower box";
}

}  // namespace
}  // namespace truestep
