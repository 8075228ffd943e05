// Rows that close up behind removed ones.
#include "engine/core/state/living_rows.h"

#include <gtest/gtest.h>

namespace truestep {
namespace {

TEST(LivingRows, EveryRowIsFoundWhereItsColumnHasIt) {
  const std::vector<std::vector<uint8_t>> deaths{
      {0, 0, 0}, {1, 1, 1}, {1, 0, 0, 1, 1, 0, 1}, {0, 1, 0, 1, 0}, {0, 0, 1, 0, 0, 1, 1, 0}};
  for (const auto& dead : deaths) {
    State s;
    const auto number = s.add({"number", "1"}, dead.size());
    for (size_t i = 0; i < dead.size(); ++i) s.f64(number)[i] = static_cast<double>(i);
    LivingRows rows;
    rows.set(dead);
    rows.close(s, number);
    const auto left = s.f64(number);
    ASSERT_EQ(left.size(), rows.kept());
    for (size_t i = 0; i < dead.size(); ++i) {
      const auto at = rows.place(i);
      ASSERT_EQ(at.has_value(), !dead[i]) << "row " << i;
      if (at) {
        EXPECT_EQ(left[*at], static_cast<double>(i));
      }
    }
    EXPECT_FALSE(rows.place(dead.size()));
  }
}

}  // namespace
}  // namespace truestep
