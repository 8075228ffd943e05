// A plot tells as many series apart as the table of integrators has rows.
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <string>

#include "engine/studies/study_result.h"

namespace truestep {
namespace {

TEST(PlotSvg, FortySeriesHaveFortyLooks) {
  StudyPlot plot;
  for (int k = 0; k < 40; ++k) plot.series.push_back({"method " + std::to_string(k), {1}, {1}});
  const std::string svg = result_svg(plot);
  // Every series has its marker on the plot's only point, all of them at one place: shape, corners and
  // colour.
  const std::regex marker("<(circle|polygon) [^>]*fill=\"#[0-9a-f]+\"/>");
  std::map<std::string, int> seen;
  for (std::sregex_iterator at(svg.begin(), svg.end(), marker), end; at != end; ++at) ++seen[at->str()];
  // In the legend a marker has a line of its own, so its places differ: only those of the plot can repeat.
  EXPECT_EQ(seen.size(), 80u);
  for (const auto& [look, times] : seen) EXPECT_EQ(times, 1) << look;
}

}  // namespace
}  // namespace truestep
