// A scene that blows up is caught while its numbers still mean something, keeps the last good state and says
// what would help; and what it suggests does help.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/scene/json.h"
#include "engine/session/session.h"

namespace truestep {
namespace {

// omega = 100 rad/s: symplectic Euler holds up to dt = 0.02 s.
std::string scene(double dt, const std::string& integrator) {
  return R"({"schema_version":"1.0","name":"stiff","time":{"dt":)" + std::to_string(dt) +
         R"(,"duration":1},"systems":[{"type":"oscillator","id":"o","mass":1,"stiffness":10000,"position":1,
         "velocity":0,"integrator":")" +
         integrator + "\"}]}";
}

Session session(double dt, const std::string& integrator) {
  return Session(std::make_shared<const World>(parse_scene(scene(dt, integrator))),
                 std::make_shared<const ThreadArena>(1));
}

TEST(Instability, ExplosionIsCaughtBeforeTheNumbersOverflow) {
  Session s = session(0.03, "symplectic_euler");
  const uint64_t done = s.step(2000);
  ASSERT_TRUE(s.failure());
  const Failure& f = *s.failure();
  EXPECT_EQ(f.system, "o");
  EXPECT_EQ(f.quantity, "velocity");
  EXPECT_EQ(f.index, 0);
  EXPECT_EQ(f.last_good_step, done);
  EXPECT_THAT(f.detail, testing::HasSubstr("exploded"));
  // The last good state is held, and it is one that a plot can show.
  const double v = s.state().systems[0].f64(s.state().systems[0].at("velocity"))[0];
  EXPECT_LT(std::abs(v), 1e8);
  EXPECT_EQ(s.step_index(), done);
}

TEST(Instability, TheSuggestionsHelp) {
  Session broken = session(0.03, "symplectic_euler");
  broken.step(2000);
  ASSERT_TRUE(broken.failure() && broken.failure()->suggested_dt);
  EXPECT_NEAR(*broken.failure()->suggested_dt, 0.02, 1e-6);  // 2 / omega
  ASSERT_GE(broken.failure()->remedies.size(), 2u);
  EXPECT_THAT(broken.failure()->detail,
              testing::AllOf(testing::HasSubstr("0.02 s"), testing::HasSubstr("integrator")));
  Session smaller = session(0.99 * *broken.failure()->suggested_dt, "symplectic_euler");
  EXPECT_EQ(smaller.step(2000), 2000u);
  // The method named in the second sentence.
  const std::string& second = broken.failure()->remedies[1];
  const std::string name = second.substr(15, second.find(' ', 15) - 15);
  Session implicit = session(0.03, name);
  EXPECT_EQ(implicit.step(2000), 2000u) << name;
}

TEST(Instability, WhatIsOnlyFastIsLeftAlone) {
  // Ten kilometres a second in a small scene is somebody's experiment, not an explosion.
  std::string fast = scene(0.001, "symplectic_euler");
  fast.replace(fast.find("\"velocity\":0"), 12, "\"velocity\":10000");
  Session s(std::make_shared<const World>(parse_scene(fast)), std::make_shared<const ThreadArena>(1));
  EXPECT_EQ(s.step(2000), 2000u);
}

TEST(Instability, BadValuesAreFoundByColumnAndRow) {
  const World world(parse_scene(scene(0.001, "rk4")));
  State s = world.initial_state().systems[0];
  EXPECT_FALSE(s.first_bad(1e3));
  const auto v = s.at("velocity");
  s.f64(v)[0] = 2e3;
  EXPECT_FALSE(s.first_bad());
  ASSERT_TRUE(s.first_bad(1e3));
  EXPECT_EQ(s.first_bad(1e3)->column, v);
  s.f64(v)[0] = NAN;
  EXPECT_TRUE(s.first_bad());
  EXPECT_TRUE(s.first_bad(1e3));
  s.f64(v)[0] = 1e200;  // its square overflows, it does not
  EXPECT_FALSE(s.first_bad());
  EXPECT_FALSE(s.first_bad(1e300));
}

}  // namespace
}  // namespace truestep
