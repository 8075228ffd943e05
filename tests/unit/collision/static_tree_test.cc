// A tree that is updated with other boxes finds the same overlaps as one built from them.
#include <gtest/gtest.h>

#include <set>

#include "engine/geometry/static_tree.h"
#include "tests/unit/soft/xpbd_numbers.h"

namespace truestep {
namespace {

TEST(StaticTree, RefittedFindsWhatOverlaps) {
  xpbd::testing_numbers::Numbers r;
  const auto scatter = [&] {
    std::vector<Box> boxes;
    for (int k = 0; k < 200; ++k) boxes.push_back(Box{{}, {}}.grown(0.1 + 0.1 * r()));
    for (Box& b : boxes) {
      const Vec3 by = r.vector();
      b.low += by, b.high += by;
    }
    return boxes;
  };
  StaticTree tree;
  tree.build(scatter());
  const std::vector<Box> boxes = scatter();
  tree.refit(boxes);
  size_t hits = 0;
  for (const Box& b : boxes) {
    std::set<uint32_t> found, expected;
    tree.overlapping(b, [&](uint32_t k) { EXPECT_TRUE(found.insert(k).second); });
    for (uint32_t k = 0; k < boxes.size(); ++k) {
      if (b.overlaps(boxes[k])) expected.insert(k);
    }
    EXPECT_EQ(found, expected);
    hits += found.size();
  }
  EXPECT_GT(hits, 300u);
}

}  // namespace
}  // namespace truestep
