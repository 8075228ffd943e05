// Random scenes keep their energy, their momentum and their place: a few hundred of them, the same ones every
// time. The program campaign judges as many more as wanted.
#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

#include "tests/stability/campaign/campaign.h"

namespace truestep::campaign {
namespace {

constexpr uint64_t kScenesEach = 15;

/// Judges the first scenes of the families whose names begin with one of `wanted`.
void judge_families(std::initializer_list<std::string_view> wanted) {
  const auto all = families();
  size_t judged = 0;
  for (size_t f = 0; f < all.size(); ++f) {
    const std::string_view name = all[f].name;
    const bool chosen = std::ranges::any_of(wanted, [&](std::string_view w) { return name.starts_with(w); });
    for (uint64_t k = 0; chosen && k < kScenesEach; ++k, ++judged) {
      const Trial trial = make_trial(f + k * all.size());
      const Outcome outcome = judge(trial);
      EXPECT_TRUE(outcome.findings.empty()) << report(trial, outcome);
    }
  }
  EXPECT_GT(judged, 0u);
}

TEST(Campaign, DropsPilesAndSlowMotion) {
  judge_families({"drop", "pile_2d", "slow"});
}
TEST(Campaign, Wheels) {
  judge_families({"wheel", "spin"});
}
TEST(Campaign, JointsAndSprings) {
  judge_families({"joints", "springs", "hinge"});
}
TEST(Campaign, RopesNetsAndEmitters) {
  judge_families({"rope", "net", "emitter"});
}
TEST(Campaign, RodChains) {
  judge_families({"rod_chain"});
}
TEST(Campaign, LinksAndEquations) {
  judge_families({"articulation", "linkage", "pendulum", "bounces"});
}

// Scenes that few draws come to: springs between jointed bodies that turn by half a radian in a step, and
// boxes and cylinders that spin on a floor by as much.
TEST(Campaign, RareScenes) {
  for (const uint64_t seed : {654, 1292, 1756, 2307, 3293, 3467, 4308, 4366, 5468, 5642, 1398, 1456, 1833,
                              3312, 3457, 4820, 8445, 8706}) {
    const Trial trial = make_trial(seed);
    const Outcome outcome = judge(trial);
    EXPECT_TRUE(outcome.findings.empty()) << report(trial, outcome);
  }
}

// A judge that finds nothing in a scene that is wrong would be worth nothing.
TEST(Campaign, JudgesFindWhatIsWrong) {
  Trial t = make_trial(0);
  t.scene["expect"] =
      boost::json::array{{{"quantity", "energy.total"}, {"max", -1e30}, {"source", "the control"}}};
  t.rules.loss = -1;
  const Outcome outcome = judge(t);
  std::string kinds;
  for (const Finding& f : outcome.findings) kinds += f.kind + ' ';
  EXPECT_NE(kinds.find("expect"), std::string::npos) << kinds;
  EXPECT_NE(kinds.find("loss"), std::string::npos) << kinds;
}

}  // namespace
}  // namespace truestep::campaign
