// Fixed bug: of pbf's corrections the pressure that was read was the last one alone, so that it fell as a
// substep had more of them. What rests on a floor does not hang on their number.
#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;

/// Pa, mean over the particles of a tank half a metre deep, after half a second and over a tenth.
double mean_pressure(int iterations) {
  SphDef d;
  d.dimension = 2, d.high = {0.5, 0.8, 1}, d.spacing = 0.025, d.solver = Method::pbf;
  d.pbf_iterations = iterations;
  d.bodies = {{.center = {0.25, 0.25, 0}, .half_extents = {0.25, 0.25, 1}}};
  SphRun run(d, 1.0 / 120, {0, -9.81, 0});
  run.seconds(0.5);
  constexpr int kSteps = 12;
  double sum = 0;
  for (int k = 0; k < kSteps; ++k) {
    run.step();
    const std::vector<double> p = run.pressures();
    for (const double at : p) sum += at / static_cast<double>(p.size() * kSteps);
  }
  return sum;
}

TEST(SphPbfPressure, DoesNotHangOnTheNumberOfCorrections) {
  // Half the depth's weight. Of these substeps (a third as many with eight) corrections leave 2 % of
  // compression, and the row on the floor carries twice its share: a tenth. The bug: a half and an eighth.
  constexpr double kMean = 1000 * 9.81 * 0.25;
  EXPECT_NEAR(mean_pressure(2), kMean, 0.15 * kMean);
  EXPECT_NEAR(mean_pressure(8), kMean, 0.15 * kMean);
}

}  // namespace
}  // namespace truestep::sph
