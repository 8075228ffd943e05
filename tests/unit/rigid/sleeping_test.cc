// The rule of rest, and penetration offsets that stop adapting.
#include "engine/rigid/sleeping.h"

#include <gtest/gtest.h>

#include "engine/kernels/rigid/penetration_offset.h"

namespace truestep {
namespace {

TEST(Sleeping, RestNeedsToBeSlowAndToStay) {
  const SleepRule rule{0.08, 0.5};
  EXPECT_DOUBLE_EQ(rule.drift(), 0.005);
  EXPECT_DOUBLE_EQ(rest_after(0.2, 0.01, 0.07, 0.004, rule), 0.21);
  EXPECT_EQ(rest_after(0.2, 0.01, 0.09, 0.004, rule), 0);
  EXPECT_EQ(rest_after(0.2, 0.01, 0.07, 0.006, rule), 0);
  // At the start of rest nothing has moved yet.
  EXPECT_DOUBLE_EQ(rest_after(0, 0.01, 0.07, 1, rule), 0.01);
}

TEST(Sleeping, WhatAConstantForcePushesDoesNotRest) {
  // An acceleration that reaches sleep_speed only after sleep_time: slow all the time, but not in one place.
  const SleepRule rule{0.05, 0.5};
  const double h = 1.0 / 240, a = 0.09;
  double rest = 0, place = 0, longest = 0, x = 0, v = 0;
  for (int i = 0; i < 240; ++i) {
    v += h * a, x += h * v;
    if (rest == 0) place = x;
    rest = rest_after(rest, h, v, x - place, rule);
    longest = std::max(longest, rest);
  }
  EXPECT_LT(longest, rule.time);
}

TEST(ContactPad, LearnsItsLoadAndThenRests) {
  const double hertz = 48, rate = 240, h = 1.0 / 60, load = 0.04;
  const PenetrationOffsetRule padding = penetration_offset_rule(hertz, rate, h, 0.5);
  const double gives = padding.per_load / kMostOffset * load;
  double pad = 0;
  for (int i = 0; i < 3000; ++i) pad = next_penetration_offset(pad, gives - pad, load, padding);
  EXPECT_GT(pad, 0.5 * gives);
  EXPECT_LT(pad, gives);
  // Small depths leave the offset unchanged, larger ones do not.
  EXPECT_EQ(next_penetration_offset(pad, 0.3 * pad, load, padding), pad);
  EXPECT_GT(next_penetration_offset(pad, 0.9 * pad, load, padding), pad);
  // The offset left by a load that is gone would lift what remains.
  EXPECT_LE(next_penetration_offset(pad, -pad, load / 100, padding), padding.per_load * load / 100);
  // One with a bound grows up to it, and a thicker one that it began with stays.
  PenetrationOffsetRule bounded = padding;
  bounded.most = 0.1 * gives;
  double thin = 0;
  for (int i = 0; i < 3000; ++i) thin = next_penetration_offset(thin, gives - thin, load, bounded);
  EXPECT_DOUBLE_EQ(thin, bounded.most);
  EXPECT_DOUBLE_EQ(next_penetration_offset(0.3 * gives, 0.7 * gives, load, bounded), 0.3 * gives);
}

}  // namespace
}  // namespace truestep
