// The divergence that is observed is that of the velocity field, to rounding for linear ones: inside, beside
// walls and at the surface.
#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;

double divergence(int dimension, const Vec3& strain, Precision precision) {
  SphDef d;
  d.dimension = dimension, d.high = {1, 1, 1}, d.spacing = 0.05, d.precision = precision;
  // On the floor, with a free surface above and at the sides.
  d.bodies = {{.center = {0.5, 0.25, 0.5}, .half_extents = {0.3, 0.25, 0.2}, .strain = strain}};
  return SphRun(d).observe("divergence.max");
}

TEST(SphDivergence, IsExactForLinearFields) {
  // Of f32, sums of some thirty (plane) and sixty neighbours: 1e-5 of the largest rate.
  for (const auto precision : {Precision::f32, Precision::f64}) {
    const double rounding = precision == Precision::f32 ? 1e-4 : 1e-12;
    EXPECT_NEAR(divergence(2, {2, 1, 0}, precision), 3, 3 * rounding);
    EXPECT_NEAR(divergence(2, {2, -2, 0}, precision), 0, 3 * rounding);
    EXPECT_NEAR(divergence(3, {1, 2, 0.5}, precision), 3.5, 3 * rounding);
    EXPECT_NEAR(divergence(3, {1, 2, -3}, precision), 0, 3 * rounding);
  }
}

}  // namespace
}  // namespace truestep::sph
