// A chain of rods with nothing said about it keeps its energy for a minute, at any step that a user would
// take and with its joints kept in any way; where a step is forced on it that it cannot bear, that is said.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/session/session.h"

namespace truestep {
namespace {

struct ChainRun {
  ChainRun(const std::string& more, double dt)
      : session(std::make_shared<const World>(parse_scene(R"({"time":{"dt":)" + std::to_string(dt) +
                                                          R"(},"systems":[{"type":"rod_chain","id":"chain")" +
                                                          more + "}]}")),
                std::make_shared<const ThreadArena>(1), {.history_bytes = 1 << 20}) {
    start = value("energy.total");
  }
  double value(const char* name) const {
    return session.observe().find(std::string("chain.") + name).value();
  }
  /// Largest rise and fall of the energy on the way, J.
  void seconds(double s) {
    const auto n = static_cast<int>(std::lround(s / session.world().dt()));
    for (int k = 0; k < n && session.step(1) == 1; ++k) {
      const double e = value("energy.total") - start;
      rise = std::max(rise, e), fall = std::min(fall, e), gap = std::max(gap, value("joints.gap"));
    }
  }
  Session session;
  double start = 0, rise = 0, fall = 0, gap = 0;
};

// What the chain could turn into speed: ten rods of 0.981 N from the anchor's height down to 1 m below.
constexpr double kAvailable = 9.81;

TEST(RodChainDefaults, EnergyIsKeptForAMinuteAtAnyStep) {
  for (const double dt : {1.0 / 240, 1.0 / 60, 1.0 / 10}) {
    ChainRun run("", dt);
    run.seconds(60);
    ASSERT_FALSE(run.session.failure()) << dt << run.session.failure()->detail;
    EXPECT_LT(run.rise, 1e-4 * kAvailable) << dt;
    EXPECT_GT(run.fall, -1e-4 * kAvailable) << dt;
    EXPECT_LT(run.gap, 1e-12) << dt;
  }
}

TEST(RodChainDefaults, SpringsAreCutIntoStepsThatTheyBear) {
  for (const double dt : {1.0 / 240, 1.0 / 60}) {
    ChainRun run(R"(,"constraints":"penalty")", dt);
    run.seconds(20);
    ASSERT_FALSE(run.session.failure()) << dt;
    // Semi-implicit Euler's energy swings by omega h / 2, an eighth here, of what is in the springs.
    EXPECT_LT(run.rise, 0.08 * kAvailable) << dt;
    EXPECT_GT(run.fall, -0.08 * kAvailable) << dt;
  }
}

TEST(RodChainDefaults, ProjectionGainsNothing) {
  for (const double dt : {1.0 / 240, 1.0 / 60, 1.0 / 10}) {
    ChainRun run(R"(,"constraints":"projection")", dt);
    run.seconds(20);
    ASSERT_FALSE(run.session.failure()) << dt;
    EXPECT_LT(run.rise, 1e-3 * kAvailable) << dt;
  }
}

TEST(RodChainDefaults, StepsThatAreForcedOnItEndInAnEvent) {
  // One step of RK4 in a sixtieth, and springs far beyond their limit.
  for (const char* more : {R"(,"substeps":1)", R"(,"constraints":"penalty","substeps":1)"}) {
    ChainRun run(more, 1.0 / 60);
    run.seconds(10);
    ASSERT_TRUE(run.session.failure()) << more;
    const Failure& f = *run.session.failure();
    EXPECT_EQ(f.system, "chain");
    EXPECT_THAT(f.detail, testing::HasSubstr("held when tried for")) << f.detail;
    ASSERT_TRUE(f.suggested_dt) << f.detail;
    EXPECT_LT(*f.suggested_dt, 1.0 / 60);
    // While its numbers still mean something.
    EXPECT_TRUE(std::isfinite(run.value("energy.total"))) << f.detail;
  }
}

}  // namespace
}  // namespace truestep
