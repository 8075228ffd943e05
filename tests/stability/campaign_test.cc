// Random scenes conserve their energy, their momentum and their place: a few hundred of them, the same ones
// every time. The program `campaign` judges as many more as desired; a scene in which it found something is
// kept below tests/scenes.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "tests/stability/campaign/campaign.h"

namespace truestep::campaign {
namespace {

constexpr uint64_t kScenesEach = 14;

class Campaign : public ::testing::TestWithParam<Family> {};

TEST_P(Campaign, HasNoFindings) {
  for (uint64_t seed = 0; seed < kScenesEach; ++seed) {
    const Trial trial = make_trial(GetParam(), seed);
    const Outcome outcome = judge(trial);
    EXPECT_TRUE(outcome.findings.empty()) << report(trial, outcome);
  }
}

std::vector<Family> judged() {
  std::vector<Family> out;
  std::ranges::copy_if(families(), std::back_inserter(out), [](const Family& f) { return !f.open; });
  return out;
}

INSTANTIATE_TEST_SUITE_P(Families, Campaign, ::testing::ValuesIn(judged()),
                         [](const auto& info) { return std::string(info.param.name); });

// A judge that finds nothing in a wrong scene would be worthless.
TEST(CampaignJudge, FindsWhatIsWrong) {
  Trial t = make_trial("drop_2d", 0);
  t.scene["expect"] =
      boost::json::array{{{"quantity", "energy.total"}, {"max", -1e30}, {"source", "the control"}}};
  t.rules.loss = -1;
  const Outcome outcome = judge(t);
  std::string kinds;
  for (const Finding& f : outcome.findings) kinds += f.kind + ' ';
  EXPECT_NE(kinds.find("energy.total"), std::string::npos) << kinds;
  EXPECT_NE(kinds.find("energy.loss"), std::string::npos) << kinds;
}

}  // namespace
}  // namespace truestep::campaign
