// Some compositions of leapfrog lose stability over an interval of steps and are stable again above it. The
// largest stable step is the end of the first stable interval; those above are reported as such.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/scene/json/json.h"
#include "engine/studies/study.h"

namespace truestep {
namespace {

StudyResult stability(const std::string& methods, const std::string& more = "") {
  const ThreadArena arena(1);
  const std::atomic<bool> cancelled{false};
  StudyContext context{.arena = arena, .cancelled = cancelled, .progress = [](double, const std::string&) {}};
  return run_study(
      read_study_request(parse_json(
          R"({"kind":"stability","integrators":)" + methods + more +
          R"(,"scene":{"schema_version":"1.0","name":"o","time":{"dt":0.1,"duration":2},"gravity":[0,0,0],
      "systems":[{"type":"oscillator","id":"o","mass":1,"stiffness":1,"position":1,"velocity":0}]}})")),
      context);
}

double number(const StudyTable::Cell& cell) {
  return std::get<double>(cell);
}

TEST(StudyStabilityWindows, TheEndOfTheFirstSpanIsReported) {
  // Omega is 1, so steps are omega h. kahan_li8 loses stability over 1.4 % of the step only.
  const auto r = stability(R"(["pefrl","kahan_li8","velocity_verlet"])", R"(,"steps":4000)");
  for (const auto& row : r.table.rows) {
    const std::string& name = std::get<std::string>(row[0]);
    EXPECT_NEAR(number(row[1]) / number(row[2]), 1, 0.02) << name;  // theory ends at the first border too
    EXPECT_EQ(std::get<std::string>(row[4]), "ok");
  }
  const auto& again = r.summary.at("stable_again").as_object();
  ASSERT_TRUE(again.contains("pefrl"));
  const auto& span = again.at("pefrl").as_array().at(0).as_object();
  EXPECT_NEAR(span.at("from").to_number<double>(), 3.5, 0.05);
  EXPECT_NEAR(span.at("to").to_number<double>(), 5.37, 0.05);
  // In the table's text, and hence on the command line and in the CSV, and in the plot.
  EXPECT_THAT(result_csv(r.table), ::testing::HasSubstr("3.5"));
  EXPECT_THAT(result_svg(r.plot), ::testing::HasSubstr("stable again"));
  // Control: leapfrog itself has one interval, and nothing is claimed above it.
  EXPECT_FALSE(again.contains("velocity_verlet"));
}

TEST(StudyStabilityWindows, MethodsWithoutALimitHaveNoBorder) {
  const auto r = stability(R"(["implicit_midpoint"])", R"(,"steps":60)");
  EXPECT_THAT(std::get<std::string>(r.table.rows[0][4]),
              ::testing::StartsWith("stable at every step tried: no limit found up to "));
}

}  // namespace
}  // namespace truestep
