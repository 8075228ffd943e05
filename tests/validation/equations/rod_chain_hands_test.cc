// Pushes, impulses and drags of a chain of rods, with each treatment of its joints: closed forms for one rod
// that turns about the anchor, without gravity.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "engine/systems/rod_chain/rod_chain.h"

namespace truestep {
namespace {

using rod_chain::RodChainDef;
using Treatment = RodChainDef::Treatment;

constexpr double kLength = 0.5, kMass = 0.3, kStep = 1.0 / 240;
constexpr double kMoment = kMass * kLength * kLength / 3;  // about the anchor
constexpr Treatment kAll[] = {Treatment::lagrange, Treatment::projection, Treatment::penalty};

struct Rods {
  explicit Rods(Treatment t, int64_t links = 1) {
    RodChainDef d;
    d.constraints = t, d.links = links, d.length = kLength, d.mass = kMass, d.damping = 1;
    BuildContext context;
    context.dt = kStep, context.gravity = {};
    system = rod_chain::build_rod_chain(&d, context);
    state = system->initial_state();
  }
  void apply(CommandKind kind, const Vec3& vector, std::optional<Vec3> at, double duration = 0,
             double value = 0) {
    Command c;
    c.kind = kind, c.index = 0, c.vector = vector, c.at = at, c.duration = duration, c.value = value;
    system->apply(state, c);
  }
  void steps(int n) {
    for (int k = 0; k < n; ++k, ++step)
      system->step(state, {static_cast<double>(step) * kStep, kStep, step, workspace, arena});
  }
  Vec3 direction() const { return load3(state.f64(state.at("direction")).data(), 0); }
  double spin() const { return state.f64(state.at("angular_velocity"))[2]; }
  double kinetic() const {
    Observables out;
    system->observe(state, 0, out);
    return out.find("energy.kinetic").value();
  }

  std::unique_ptr<const System> system;
  State state;
  Workspace workspace;
  ThreadArena arena{1};
  uint64_t step = 0;
};

// The work of a constant force is its product with the way of the point where it acts.
TEST(RodChainHands, APushAtTheEndWorksByItsWay) {
  constexpr double kForce = 0.4;
  // Exact; losses of h / T; the joint's spring takes part of the work.
  const double share[] = {1e-8, 0.05, 0.01};
  for (const Treatment t : kAll) {
    Rods end(t), centre(t);
    end.apply(CommandKind::push, {0, kForce, 0}, Vec3{kLength, 0, 0}, 0.25);
    centre.apply(CommandKind::push, {0, kForce, 0}, std::nullopt, 0.25);
    end.steps(60), centre.steps(60);
    const double work = kForce * kLength * end.direction().y;
    EXPECT_NEAR(end.kinetic(), work, share[static_cast<size_t>(t)] * work) << static_cast<int>(t);
    EXPECT_GT(end.direction().y, 0.2);
    // The control: at the centre it has half the arm.
    EXPECT_LT(centre.spin(), 0.6 * end.spin());
    const double before = end.kinetic();
    end.steps(20);
    EXPECT_NEAR(end.kinetic(), before, 0.05 * before) << "it ends with its duration";
  }
}

TEST(RodChainHands, AnImpulseTurnsTheRodAboutTheAnchor) {
  constexpr double kImpulse = 0.02;
  for (const Treatment t : kAll) {
    Rods rods(t);
    rods.apply(CommandKind::impulse, {0, kImpulse, 0}, Vec3{kLength, 0, 0});
    const double spin = kImpulse * kLength / kMoment;
    if (t == Treatment::penalty) {
      // The spring of a joint and its damping take what would move the anchor.
      rods.steps(240);
    } else {
      EXPECT_NEAR(rods.spin(), spin, 1e-12 * spin) << "at once";
    }
    EXPECT_NEAR(rods.spin(), spin, 0.02 * spin) << static_cast<int>(t);
  }
}

TEST(RodChainHands, ADragBringsTheEndToItsTargetUntilReleased) {
  for (const Treatment t : kAll) {
    for (const double stiffness : {0.0, 1e4}) {
      Rods rods(t);
      rods.apply(CommandKind::drag, {0, kLength, 0}, Vec3{kLength, 0, 0}, 0, stiffness);
      rods.steps(720);
      // A damping ratio of 0.7: after three seconds the usual drag, the softest, has left e^-12.
      EXPECT_NEAR(rods.direction().y, 1, 1e-6) << static_cast<int>(t) << ' ' << stiffness;
      EXPECT_NEAR(rods.spin(), 0, 1e-3) << static_cast<int>(t) << ' ' << stiffness;
      rods.apply(CommandKind::release, {}, std::nullopt);
      rods.apply(CommandKind::impulse, {-0.2, 0, 0}, Vec3{0, kLength, 0});
      rods.steps(60);
      EXPECT_LT(rods.direction().y, 0.9) << "nothing holds it any more";
    }
  }
}

TEST(RodChainHands, RowsAndCommandsThatThereAreNotAreNamed) {
  Rods rods(Treatment::lagrange);
  Command c;
  c.kind = CommandKind::push, c.index = 1;
  EXPECT_THROW(rods.system->apply(rods.state, c), Error);
  c.kind = CommandKind::pin, c.index = 0;
  EXPECT_THROW(rods.system->apply(rods.state, c), Error);
}

}  // namespace
}  // namespace truestep
