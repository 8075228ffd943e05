// Extremes of soft bodies in the system xpbd: elastic and matched blocks from 1e2 to 1e9 Pa and 0.1 to 1000
// Hz at steps of 1/30 to 1/1000 s, slabs of 1:1000, blocks crushed flat, cloth torn to single triangles and
// rods of hard wire.
#include "engine/base/errors.h"
#include "tests/unit/soft/xpbd_rig.h"

namespace truestep {
using namespace xpbd;
namespace {

using testing_rig::XpbdRun;

XpbdDef dropped(const Vec3& size) {
  XpbdDef d;
  d.block = SoftBlockShape{.origin = {0, 0.05, 0}, .size = size, .cells_x = 3, .cells_y = 3, .cells_z = 3};
  d.density = 1000, d.velocity = {0.3, -2, 0.1};
  d.colliders.push_back(PlaneColliderDef{});
  return d;
}
/// Largest kinetic energy relative to the total at the start, the floor being at zero.
double gain(const XpbdDef& d, double dt) {
  XpbdRun run(d, dt);
  const double start = run.observe("energy.total");
  double most = start;
  for (int k = 0; k < 60; ++k) {
    run.step();
    most = std::max(most, run.observe("energy.kinetic"));
  }
  EXPECT_TRUE(run.finite());
  return most / start;
}

TEST(XpbdSoftStability, BlocksOfAnyStiffnessMoveNoFasterThanTheyFell) {
  int refused = 0;
  for (const Vec3& size : {Vec3{0.2, 0.2, 0.2}, Vec3{1, 0.001, 1}, Vec3{0.001, 1, 0.001}}) {
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 1000}) {
      for (const double modulus : {1e2, 1e5, 1e9}) {
        XpbdDef d = dropped(size);
        d.youngs_modulus = modulus, d.poisson_ratio = 0.45;
        // A block that would need more than a thousand substeps is refused. In the first step it still falls:
        // the kinetic energy grows by at most h g v, 7 %.
        try {
          EXPECT_LT(gain(d, dt), 1.1) << modulus << " " << dt << " " << size.y;
        } catch (const Error&) {
          EXPECT_GT(modulus, size.x == size.y ? 1e8 : 1e4);
          ++refused;
        }
      }
      for (const double frequency : {0.1, 5.0, 1000.0}) {
        // Stiff thin bodies tip over as a whole: they are drawn soft.
        if (size.x != size.y && frequency > 5) continue;
        XpbdDef d = dropped(size);
        d.matching = MatchDef{.frequency = frequency, .linear = size.x == size.y ? 0.5 : 0};
        EXPECT_LT(gain(d, dt), 1.1) << frequency << " " << dt << " " << size.y;
      }
    }
  }
  EXPECT_LE(refused, 11);
  // Control: the few substeps of a soft block are too few for a stiff one.
  XpbdDef d = dropped({0.2, 0.2, 0.2});
  d.youngs_modulus = 1e9, d.poisson_ratio = 0.45, d.substeps = 10;
  EXPECT_GT(gain(d, 1.0 / 60), 100);
}

TEST(XpbdSoftStability, ABlockCrushedFlatComesBack) {
  for (const bool matched : {true, false}) {
    XpbdDef d = dropped({0.2, 0.2, 0.2});
    d.colliders = {}, d.velocity = {}, d.damping = 0.2;
    if (matched) {
      d.matching = MatchDef{.frequency = 4, .linear = 0.3};
    } else {
      d.youngs_modulus = 1e5, d.poisson_ratio = 0.4;
    }
    XpbdRun run(d, 1.0 / 60, {});
    const auto x = run.state.f64(XpbdColumns::position);
    // Crushed to a twentieth of its height, with a tenth of a millimetre of disorder.
    for (size_t k = 1; k < x.size(); k += 3) {
      x[k] = 0.05 * x[k] + 1e-4 * static_cast<double>((k * 7919) % 13) / 13;
    }
    run.seconds(8);
    EXPECT_TRUE(run.finite());
    EXPECT_NEAR(run.observe("volume"), 0.008, 0.01 * 0.008) << matched;
  }
}

TEST(XpbdSoftStability, ClothIsTornToPiecesWithoutHarm) {
  for (const double dt : {1.0 / 30, 1.0 / 240}) {
    XpbdDef d;
    d.cloth_grid = ClothGridShape{.nx = 15, .ny = 15};
    d.mass = 1e-3, d.stiffness = 1e4, d.flexural_rigidity = 1e-4;
    d.tear = TearDef{.strain = 1e-6, .most_splits = 2000};
    d.pinned = {"corners"};
    d.colliders.push_back(PlaneColliderDef{{}, {0, -0.5, 0}});
    XpbdRun run(d, dt);
    run.seconds(3);
    EXPECT_TRUE(run.finite());
    EXPECT_GT(run.observe("splits"), 100);
    double mass = 0;
    for (const double m : run.state.f64(run.state.at("mass"))) mass += m;
    EXPECT_NEAR(mass, 0.225, 1e-13);
  }
}

TEST(XpbdSoftStability, RodsFromThreadToSteelStayWithinTheirReach) {
  for (const double modulus : {1e3, 1e7, 2e11}) {
    for (const double dt : {1.0 / 30, 1.0 / 1000}) {
      XpbdDef d;
      d.rope = RopeShape{.to = {1, 0, 0}, .links = 20};
      d.thickness = 0.01, d.density = 0.1;
      d.rod = RodDef{.youngs_modulus = modulus, .clamped = {"first"}};
      XpbdRun run(d, dt);
      const double start = run.observe("energy.total");
      run.seconds(1);
      EXPECT_TRUE(run.finite());
      // It falls with its stored energy; no energy is gained, to a thousandth of a metre's fall.
      EXPECT_LT(run.observe("energy.total") - start, 1e-3 * 0.1 * 9.81) << modulus << " " << dt;
    }
  }
}

}  // namespace
}  // namespace truestep
