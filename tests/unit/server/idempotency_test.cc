// Answers that are given again to who repeats a request.
#include "server/sessions/idempotency.h"

#include <gtest/gtest.h>

#include "engine/base/errors.h"

namespace truestep {
namespace {

std::string refusal(IdempotencyKeys& keys, const std::string& key, uint64_t hash) {
  try {
    keys.begin(key, hash);
  } catch (const Error& e) {
    return e.code();
  }
  return "";
}

TEST(Idempotency, AnAnswerIsGivenAgainAndAKeyServesOneRequest) {
  IdempotencyKeys keys;
  EXPECT_FALSE(keys.begin("a", 1));
  EXPECT_EQ(refusal(keys, "a", 1), "conflict") << "it is being answered";
  keys.remember("a", {1, 201, "{}", "/v1/sessions/s"});
  EXPECT_EQ(refusal(keys, "a", 2), "idempotency_key_reused");
  const auto again = keys.begin("a", 1);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->status, 201);
  EXPECT_EQ(again->location, "/v1/sessions/s");
}

TEST(Idempotency, TheOldestAnswersAreForgottenFirst) {
  IdempotencyKeys keys(2);
  for (const char* key : {"a", "b", "c"}) {
    EXPECT_FALSE(keys.begin(key, 1));
    keys.remember(key, {1, 200, "", ""});
  }
  EXPECT_TRUE(keys.begin("b", 1));
  EXPECT_TRUE(keys.begin("c", 1));
  EXPECT_FALSE(keys.begin("a", 1));
}

// However many keys one caller uses, another's answer stays.
TEST(Idempotency, ACallersAnswersAreForgottenForItsOwn) {
  IdempotencyKeys keys(10);
  EXPECT_FALSE(keys.begin("alice\none", 1));
  keys.remember("alice\none", {1, 200, "", ""});
  for (int k = 0; k < 1000; ++k) {
    const std::string key = "bob\n" + std::to_string(k);
    EXPECT_FALSE(keys.begin(key, 1));
    keys.remember(key, {1, 200, "", ""});
  }
  EXPECT_TRUE(keys.begin("alice\none", 1));
  EXPECT_TRUE(keys.begin("bob\n999", 1));
  EXPECT_FALSE(keys.begin("bob\n0", 1));
}

// A request that failed may be sent again, and its key lives as long as any other from then on.
TEST(Idempotency, AForgottenKeyBeginsAnew) {
  IdempotencyKeys keys(2);
  EXPECT_FALSE(keys.begin("a", 1));
  keys.forget("a");
  EXPECT_FALSE(keys.begin("b", 1));
  keys.remember("b", {1, 200, "", ""});
  EXPECT_FALSE(keys.begin("a", 2));
  keys.remember("a", {2, 200, "", ""});
  EXPECT_TRUE(keys.begin("b", 1));
  EXPECT_TRUE(keys.begin("a", 2));
  // Now b is the oldest, and makes room.
  EXPECT_FALSE(keys.begin("c", 1));
  EXPECT_TRUE(keys.begin("a", 2));
  EXPECT_FALSE(keys.begin("b", 1));
}

}  // namespace
}  // namespace truestep
