// Pushes of users last as many steps as their time has, however it rounds.
#include <gtest/gtest.h>

#include "engine/core/commands/user_forces.h"

namespace truestep {
namespace {

TEST(PushesEnd, AfterAsManyStepsAsTheyLast) {
  State s;
  const auto who = s.add({"push.row", "1", Scalar::u32}, 0);
  const auto force = s.add({"push.force", "N", Scalar::f64, 3}, 0);
  const auto remaining = s.add({"push.remaining", "s"}, 0);
  const UserForces hands(UserForces::PushColumns{.who = who, .force = force, .remaining = remaining});
  for (const double h : {0.1, 0.01, 1.0 / 60, 1.0 / 1024, 0.003}) {
    for (const int steps : {1, 2, 3, 7, 10, 33, 100}) {
      hands.add_push(s, {5, {1, 2, 3}, {}}, steps * h);
      for (int k = 0; k < steps; ++k) {
        ASSERT_EQ(hands.pushes(s), 1u) << k << " of " << steps << " steps of " << h;
        EXPECT_EQ(hands.push(s, 0).who, 5u);
        hands.count_down(s, h);
      }
      ASSERT_EQ(hands.pushes(s), 0u) << steps << " steps of " << h;
    }
  }
}

}  // namespace
}  // namespace truestep
