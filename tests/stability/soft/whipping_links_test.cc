// Chains of links whip: their ends turn faster from step to step, the effective masses of their joints
// change, and implicit Euler, which damps joints of constant mass, feeds them. Steps that gain energy, or
// have no solution, are taken again in parts.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/integrators/table/integrators.h"
#include "engine/systems/articulation/articulation.h"

namespace truestep {
namespace {

using namespace articulation;

constexpr double kLength = 0.4, kThick = 0.1;  // m

/// Free boxes of 1 kg in a row, released from the horizontal.
ArticulationDef chain(int links) {
  ArticulationDef d;
  for (int i = 0; i < links; ++i) {
    LinkDef l;
    const double across = (kLength * kLength + kThick * kThick) / 12;
    l.joint = JointType::revolute, l.mass = 1, l.center = {0.5 * kLength, 0, 0};
    l.inertia = {kThick * kThick / 6, across, across};
    if (i > 0) l.offset = {kLength, 0, 0};
    d.links.push_back(l);
  }
  return d;
}

/// The most that is gained over the start in 5 s, by the system or by its method alone, as a fraction of what
/// the fall to the lowest place releases.
enum class By : uint8_t { system, method };
double gain(int links, const char* method, double dt, By by) {
  ArticulationDef d = chain(links);
  d.integrator = method;
  BuildContext context{.id = "a"};
  context.gravity = {0, -9.81, 0}, context.dt = dt;
  const auto system = build_articulation(&d, context);
  const ArticulationField field(build_model(d), context.gravity);
  State state = system->initial_state();
  Workspace workspace, other;
  const ThreadArena arena(1);
  const auto energy = [&] {
    const Energy e = system->energy(state, 0, other, arena).value();
    return e.kinetic + e.potential;
  };
  const double start = energy();
  double most = 0;
  for (uint64_t n = 0; double(n) * dt < 5; ++n) {
    const StepInput in{.t = double(n) * dt, .h = dt, .step = n, .workspace = workspace, .arena = arena};
    if (by == By::system) {
      system->step(state, in);
    } else {
      find_integrator(method)->step(field, state, in, {});
    }
    most = std::max(most, energy() - start);
  }
  return most / (links * 9.81 * 0.5 * links * kLength);
}

// Of first order, what is gained falls with the step from 1 ms on, and below that the bound lets it pass.
TEST(WhippingLinks, StepsThatFeedThemAreTakenAgain) {
  for (const int links : {10, 20}) {
    for (const double dt : {1.0 / 60, 1.0 / 240, 0.002, 0.001, 0.00025}) {
      EXPECT_LT(gain(links, "implicit_euler", dt, By::system), 0.005) << links << ' ' << dt;
    }
    EXPECT_LT(gain(links, "linear_implicit_euler", 0.002, By::system), 0.005) << links;
  }
}

TEST(WhippingLinks, TheMethodAloneFeedsThem) {
  EXPECT_GT(gain(10, "implicit_euler", 0.002, By::method), 0.04);
  EXPECT_GT(gain(20, "implicit_euler", 0.002, By::method), 0.04);
}

}  // namespace
}  // namespace truestep
