// The accumulator: wall time in, whole steps out, without drift and without unlimited backlog.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/session/session.h"

namespace truestep {
namespace {

Session make_session(const char* time) {
  return Session(
      std::make_shared<const World>(parse_scene(std::string(R"({"time": )") + time +
                                                R"(, "systems": [{"type": "oscillator", "id": "a"}]})")),
      std::make_shared<const ThreadArena>(1));
}

TEST(SessionClock, WholeStepsAndAFraction) {
  Session s = make_session(R"({"dt": 0.01})");
  EXPECT_EQ(s.advance(1.0), 0u) << "a paused session does not move";
  s.play(1);
  EXPECT_EQ(s.advance(0.025), 2u);
  EXPECT_NEAR(s.alpha(), 0.5, 1e-12);  // rounding of 0.025 - 2 * 0.01
  EXPECT_EQ(s.advance(0.005), 1u);
  EXPECT_EQ(s.step_index(), 3u);
  EXPECT_EQ(s.time(), 0.03);  // 3 * dt exactly, not a sum
}

TEST(SessionClock, SpeedScalesTime) {
  Session s = make_session(R"({"dt": 0.01})");
  s.play(2);
  EXPECT_EQ(s.advance(0.021), 4u);
}

TEST(SessionClock, LateSessionSkipsTimeInsteadOfFallingBehind) {
  Session s = make_session(R"({"dt": 0.01, "max_catchup_steps": 5})");
  s.play(1);
  EXPECT_EQ(s.advance(1.0), 5u);
  EXPECT_EQ(s.skipped_steps(), 95u);
  EXPECT_LT(s.alpha(), 1.0);
  EXPECT_EQ(s.advance(0.01), 1u) << "the backlog is gone";
}

TEST(SessionClock, ShortStepsAreNotLate) {
  Session s = make_session(R"({"dt": 0.0001, "max_catchup_steps": 5})");
  s.play(1);
  EXPECT_EQ(s.advance(1.0 / 60), 166u);
  EXPECT_EQ(s.skipped_steps(), 0u);
}

TEST(SessionClock, BadSpeedsAreRefused) {
  Session s = make_session(R"({"dt": 0.01})");
  for (const double speed : {0.0, -1.0, 1e16, 1e-19, std::nan(""), HUGE_VAL})
    EXPECT_THROW(s.play(speed), Error) << speed;
}

TEST(SessionClock, BlowUpIsReportedWithTheLastGoodStep) {
  // Explicit Euler on a stiff spring leaves the range of doubles after some hundred steps.
  Session s(
      std::make_shared<const World>(parse_scene(
          R"({"time": {"dt": 1}, "systems": [{"type": "oscillator", "id": "a", "stiffness": 1e6, "position": 1, "integrator": "euler"}]})")),
      std::make_shared<const ThreadArena>(1));
  const uint64_t done = s.step(1000);
  ASSERT_TRUE(s.failure().has_value());
  EXPECT_LT(done, 1000u);
  EXPECT_EQ(s.failure()->system, "a");
  EXPECT_EQ(s.failure()->last_good_step, done);
  EXPECT_EQ(s.step_index(), done);
  EXPECT_FALSE(s.state().systems[0].first_bad());
  EXPECT_THROW(s.step(1), Error);
  s.reset();
  EXPECT_FALSE(s.failure());
}

}  // namespace
}  // namespace truestep
