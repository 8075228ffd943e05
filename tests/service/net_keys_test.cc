// The throttle on guessed keys: what it costs, who is exempt, and that its memory stays small whoever
// connects.
#include "server/net/access/key_throttle.h"

#include <gtest/gtest.h>

namespace truestep::net {
namespace {

using namespace std::chrono_literals;

const KeyThrottle::Clock::time_point kStart{1000h};

TEST(KeyThrottle, TenWrongKeysAreFreeThenOneEverySixSeconds) {
  KeyThrottle throttle;
  for (int i = 0; i < KeyThrottle::kFreeFailures; ++i) {
    EXPECT_EQ(throttle.wait("192.0.2.1:1000", "x", kStart), 0) << i;
    throttle.failed("192.0.2.1:" + std::to_string(1000 + i), kStart);
  }
  EXPECT_EQ(throttle.wait("192.0.2.1:9", "x", kStart), 6);
  EXPECT_EQ(throttle.wait("192.0.2.2:9", "x", kStart), 0) << "another address";
  EXPECT_EQ(throttle.wait("192.0.2.1:9", "x", kStart + 6s), 0);
  throttle.failed("192.0.2.1:9", kStart + 6s);
  EXPECT_EQ(throttle.wait("192.0.2.1:9", "x", kStart + 6s), 6);
  EXPECT_EQ(throttle.wait("192.0.2.1:9", "x", kStart + 120s), 0);
}

TEST(KeyThrottle, AKeyThatWasRightIsLetThroughAtItsOwnAddress) {
  KeyThrottle throttle;
  throttle.succeeded("192.0.2.1:1", "right", kStart);
  for (int i = 0; i < 50; ++i) throttle.failed("192.0.2.1:1", kStart), throttle.failed("192.0.2.2:1", kStart);
  EXPECT_EQ(throttle.wait("192.0.2.1:1", "right", kStart), 0);
  EXPECT_GT(throttle.wait("192.0.2.1:1", "other", kStart), 0);
  EXPECT_GT(throttle.wait("192.0.2.2:1", "right", kStart), 0);
}

TEST(KeyThrottle, AnAddressOfIpv6IsItsNetwork) {
  EXPECT_EQ(network_of("[2001:db8:1:2:3:4:5:6]:80"), network_of("[2001:db8:1:2:ffff::1]:81"));
  EXPECT_NE(network_of("[2001:db8:1:2::1]:80"), network_of("[2001:db8:1:3::1]:80"));
  EXPECT_EQ(network_of("[::ffff:192.0.2.1]:80"), network_of("192.0.2.1:81"));
}

TEST(KeyThrottle, StaysSmallAndForgetsTheMostHarmlessFirst) {
  KeyThrottle throttle;
  for (int i = 0; i < 40; ++i) throttle.failed("192.0.2.1:1", kStart);
  for (int i = 0; i < 6000; ++i) {
    throttle.failed("10." + std::to_string(i >> 8) + "." + std::to_string(i & 255) + ".1:1", kStart);
    throttle.succeeded("192.0.2.9:1", std::to_string(i), kStart);
  }
  EXPECT_LE(throttle.rows(), 2 * KeyThrottle::kMostRows);
  EXPECT_GT(throttle.wait("192.0.2.1:1", "x", kStart), 0);
}

}  // namespace
}  // namespace truestep::net
