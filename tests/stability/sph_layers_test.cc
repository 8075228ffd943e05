// What a liquid of layers bears by its weight.
#include <gtest/gtest.h>

#include "engine/systems/sph/solvers/layer_load.h"
#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;

/// Two layers in the plane, each a third of the box; densities over 1000 kg/m^3.
SphDef two_layers(double below, double above) {
  SphDef d;
  d.dimension = 2, d.solver = Method::pbf, d.precision = Precision::f64, d.spacing = 0.04;
  d.high = {0.8, 0.96, 0};
  const Vec3 half{0.4, 0.16, 0.5};
  d.bodies = {{.center = {0.4, 0.16, 0}, .half_extents = half, .density = 1000 * below},
              {.center = {0.4, 0.48, 0}, .half_extents = half, .density = 1000 * above}};
  return d;
}

TEST(SphLayerLoad, IsTheWeightOverTheLightest) {
  const auto load = [](double below, double above) {
    const SphRun run(two_layers(below, above));
    std::vector<double> scratch;
    return load_by_weight<2>(run.system.setting(), run.state.span<double>(columns::position).data(),
                             run.state.span<double>(run.system.setting().ratio).data(),
                             run.system.setting().rows, {0, -9.81, 0}, scratch);
  };
  // On the lowest layer, all of it; where light is above, on the heavy.
  EXPECT_NEAR(load(1, 10), 9.81 * 0.32 * 11, 1e-9);
  EXPECT_NEAR(load(10, 1), 9.81 * 0.32 * 1.1, 1e-9) << "control: upside down";
}

}  // namespace
}  // namespace truestep::sph
