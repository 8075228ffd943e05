// A step prescribed for a chain of rods that it cannot sustain is reported. (Its energies are in
// tests/scenes/chains.)
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
                std::make_shared<const ThreadArena>(1), {.history_bytes = 1 << 20}) {}
  double value(const char* name) const {
    return session.observe().find(std::string("chain.") + name).value();
  }
  Session session;
};

TEST(RodChainDefaults, StepsThatAreForcedOnItEndInAnEvent) {
  // One step of RK4 in a sixtieth of a second, and springs far beyond their limit.
  for (const char* more : {R"(,"substeps":1)", R"(,"constraints":"penalty","substeps":1)"}) {
    ChainRun run(more, 1.0 / 60);
    run.session.step(600);
    ASSERT_TRUE(run.session.failure()) << more;
    const Failure& f = *run.session.failure();
    EXPECT_EQ(f.system, "chain");
    EXPECT_THAT(f.detail, ::testing::HasSubstr("held when tried for")) << f.detail;
    ASSERT_TRUE(f.suggested_dt) << f.detail;
    EXPECT_LT(*f.suggested_dt, 1.0 / 60);
    // Reported while the numbers are still meaningful.
    EXPECT_TRUE(std::isfinite(run.value("energy.total"))) << f.detail;
  }
}

}  // namespace
}  // namespace truestep
