// Studies: known numbers are found, and what cannot be known is not claimed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "engine/base/errors.h"
#include "engine/scene/json/json.h"
#include "engine/studies/convergence.h"
#include "engine/studies/precision/work_precision.h"
#include "engine/studies/scene_variant.h"
#include "engine/studies/trajectory.h"
#include "tests/support/slowdown.h"
#include "tests/unit/studies/study_rig.h"

namespace truestep {
namespace {

using testing_rig::kCloth;
using testing_rig::kOscillator;
using testing_rig::Study;
namespace json = boost::json;

std::string first_pointer(const std::string& request) {
  try {
    read_study_request(parse_json(request));
  } catch (const Error& e) {
    return e.issues().empty() ? "(none)" : e.issues().front().pointer;
  }
  return "(accepted)";
}

TEST(SceneVariant, SetsMembersAndElements) {
  json::value d = parse_json(R"({"a":[{"b":1},{"c/d":2}]})");
  set_at(d, "/a/0/b", 5);
  set_at(d, "/a/1/c~1d", 6);
  set_at(d, "/time/dt", 0.5);
  EXPECT_EQ(d, parse_json(R"({"a":[{"b":5},{"c/d":6}],"time":{"dt":0.5}})"));
  for (const char* bad : {"a", "/a/2/b", "/a/x", "/a/0/b/deeper"})
    EXPECT_THROW(set_at(d, bad, 1), Error) << bad;
}

TEST(ObservedOrder, QuotesOnlyWhatHasSettled) {
  std::vector<double> clean, wobbling;
  for (int k = 0; k < 6; ++k) {
    clean.push_back(3.0 * std::pow(2.0, -4.0 * k));
    wobbling.push_back(std::pow(2.0, -2.0 * k) * (k % 2 ? 1.5 : 1.0));
  }
  const auto settled = observed_order(clean, 1e-12);
  ASSERT_TRUE(settled.settled);
  EXPECT_NEAR(*settled.settled, 4, 1e-12);  // exact powers of two
  EXPECT_FALSE(observed_order(wobbling, 1e-12).settled);
  // Five halvings from 1 to 1.5 / 4^5, however the ones between scatter.
  EXPECT_NEAR(observed_order(wobbling, 1e-12).mean.value_or(0), 2 - std::log2(1.5) / 5, 1e-12);
  EXPECT_FALSE(observed_order({4, 2, 1}, 1e-12).mean) << "two halvings are too few";
  // The same clean errors under a coarse reference leave fewer than three halvings.
  EXPECT_FALSE(observed_order(clean, 0.01).settled);
  EXPECT_FALSE(observed_order({NAN, NAN, 1, 0.5}, 1e-12).settled);
}

TEST_F(Study, ConvergenceFindsTheOrderOfEachMethod) {
  for (const auto& [name, order] : {std::pair{"symplectic_euler", 1.0}, {"heun", 2.0}, {"rk4", 4.0}}) {
    const auto r = run(with("convergence", std::string("\"integrator\":\"") + name + "\",\"step\":0.02"));
    ASSERT_TRUE(r.summary.at("observed_order").is_double()) << name << ' ' << json::serialize(r.summary);
    EXPECT_NEAR(r.summary.at("observed_order").as_double(), order, 0.1) << name;
  }
}

TEST_F(Study, ConvergenceOfAdaptiveMethodsIsByToleranceAndSaysTheirOwnSteps) {
  // Systems of equations report the work of their methods.
  const char* swing = R"({"schema_version":"1.0","name":"swing","time":{"dt":0.5,"duration":2},
    "systems":[{"type":"ode","id":"o","states":{"x":1,"v":0},"equations":{"x":"v","v":"-100*x"},
                "integrator":"dopri5"}]})";
  const auto r = run(with("convergence", R"("integrator":"dopri5","budget":3)", swing));
  ASSERT_GE(r.table.rows.size(), 4u);
  EXPECT_EQ(r.table.columns[0].name, "tolerance");
  EXPECT_EQ(r.plot.x_label, "tolerance");
  EXPECT_EQ(r.plot.series.size(), 1u);  // no reference line of an order that was not promised
  const auto value = [&](size_t row, size_t column) { return std::get<double>(r.table.rows[row][column]); };
  // Between two tolerances a factor of a thousand apart, a method of order 5 needs 1000^(1/5) = 4 times the
  // steps.
  EXPECT_NEAR(value(3, 0) / value(0, 0), 1e-3, 1e-9);
  EXPECT_GT(value(3, 1), 2 * value(0, 1));
  EXPECT_LT(value(3, 2), value(0, 2));
}

TEST_F(Study, WorkPrecisionRanksHigherOrderFirstAtSmallErrors) {
  const auto r =
      run(with("work_precision", R"("integrators":["symplectic_euler","rk4","dopri5"],"budget":5)"));
  const auto& cheapest = r.summary.at("cheapest").as_array();
  ASSERT_FALSE(cheapest.empty());
  for (const json::value& row : cheapest) {
    // At 1e-6 a method of first order would need some 1e7 steps where rk4 needs 1e3.
    if (row.at("error").as_double() <= 1e-6) {
      EXPECT_NE(row.at("integrator").as_string(), "symplectic_euler");
    }
  }
  EXPECT_LT(r.summary.at("reference").at("uncertainty").as_double(), 1e-9);
  EXPECT_THAT(result_csv(r.table), ::testing::StartsWith("integrator,setting,cpu_seconds (s),"));
  EXPECT_THAT(result_svg(r.plot),
              ::testing::AllOf(::testing::HasSubstr("dopri5"), ::testing::EndsWith("</svg>\n")));
}

TEST_F(Study, ErrorsOfTheReferenceAreThoseOfTheClosedForm) {
  // x(t) = e^{-t} (cos wt + sin wt / w), w^2 = 99: the reference's end against it.
  const json::value scene = parse_json(kOscillator);
  WorkPrecisionParams p;
  p.integrators = {"rk4"}, p.steps = {0.01}, p.budget = 5;
  const auto m = measure_work(scene, p, context);
  const double w = std::sqrt(99.0), exact = std::exp(-2.0) * (std::cos(2 * w) + std::sin(2 * w) / w);
  EXPECT_NEAR(m.reference.trace.values.back()[0], exact, 1e-9);
  // And the error reported for rk4 is the one against the closed form, to the reference's own error.
  ASSERT_EQ(m.points.size(), 1u);
  EXPECT_GT(m.points[0].error_end, 1e-6);
  EXPECT_EQ(m.points[0].status, "ok");
}

TEST_F(Study, AStudyCoversWhatItsBudgetReachesAndSaysSo) {
  const std::string budget = R"("budget":)" + std::to_string(2 * kSlowdown);
  const std::string rest = R"("integrators":["rk4","velocity_verlet"],)" + budget;
  const auto shortened = run(with("work_precision", rest, kCloth));
  const double horizon = shortened.summary.at("horizon").as_double();
  EXPECT_GT(horizon, 0.005);
  EXPECT_LT(horizon, 60);
  EXPECT_THAT(std::string(shortened.summary.at("note").as_string()),
              ::testing::HasSubstr("of the scene's 60 s"));
  EXPECT_FALSE(shortened.plot.series.empty());
  // Controls: a requested horizon is kept or refused, and a cheap scene is covered completely.
  try {
    run(with("work_precision", rest + R"(,"horizon":60)", kCloth));
    ADD_FAILURE() << "a minute of this cloth cannot be measured in that time";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), "study_failed");
    ASSERT_FALSE(e.issues().empty());
    EXPECT_EQ(e.issues().front().pointer, "/horizon");
  }
  const auto whole = run(with("work_precision", R"("integrators":["rk4"],)" + budget));
  EXPECT_EQ(whole.summary.at("horizon").as_double(), 2);
  EXPECT_FALSE(whole.summary.contains("note"));
}

TEST_F(Study, NoErrorIsQuotedBelowWhatTheReferenceKnows) {
  // A bouncing ball: the step in which it hits the floor changes its path by more than any method does.
  const std::string ball = R"({"schema_version":"1.0","name":"ball","time":{"dt":0.01,"duration":1},
    "systems":[{"type":"particles","id":"b","positions":[[0,1,0]],"mass":1,
                "colliders":[{"type":"plane","restitution":0.5}]}]})";
  const std::string rest = R"("integrators":["rk4","dopri5"],"budget":2)";
  const auto lowest = [](const StudyResult& r) {
    double least = 1;
    for (const json::value& row : r.summary.at("cheapest").as_array())
      least = std::min(least, row.at("error").as_double());
    return least;
  };
  const auto bouncing = run(with("work_precision", rest, ball));
  EXPECT_GE(lowest(bouncing), 10 * bouncing.summary.at("reference").at("uncertainty").as_double());
  EXPECT_THAT(std::string(bouncing.summary.at("reference").at("method").as_string()),
              ::testing::HasSubstr("dt / 8"));
  // Control: the same without a floor is smooth, accurate to rounding, and reported far below that.
  const auto falling = run(with("work_precision", rest));
  EXPECT_LT(lowest(falling), 1e-6);
}

TEST_F(Study, CrossCheckOfAMethodWithItselfIsZero) {
  const auto same =
      run(with("cross_check", R"("a":{"integrator":"rk4"},"b":{"integrator":"rk4"},"samples":10)"));
  EXPECT_EQ(same.summary.at("difference_at_end").as_double(), 0);
  const auto other =
      run(with("cross_check", R"("a":{"integrator":"euler"},"b":{"integrator":"rk4"},"samples":10)"));
  EXPECT_GT(other.summary.at("difference_at_end").as_double(), 1e-4);
}

TEST_F(Study, SweepMeasuresEveryCaseAndGoesOn) {
  const std::string request = with("sweep", R"j("axes":[{"pointer":"/systems/0/stiffness","values":[100,400]},
    {"pointer":"/systems/0/damping","min":0,"max":2,"count":3}],"measure":["energy.total","max(energy.total)"])j");
  std::vector<json::object> rows;
  context.row_finished = [&](const json::object& row) { rows.push_back(row); };
  const auto whole = run(request);
  ASSERT_EQ(whole.table.rows.size(), 6u);
  EXPECT_EQ(rows.size(), 6u);
  // E0 = k/2; without damping it stays (rk4 at w h = 0.1 loses 1e-8 of it a step).
  EXPECT_NEAR(std::get<double>(whole.table.rows[0][3]), 50, 1e-3);
  EXPECT_LT(std::get<double>(whole.table.rows[2][3]), 5);
  // Only the second half is run if the first is known, and the table is the same.
  context.finished_rows = {rows[0], rows[1], rows[2]};
  rows.clear();
  const auto resumed = run(request);
  EXPECT_EQ(rows.size(), 3u);
  EXPECT_EQ(result_csv(resumed.table), result_csv(whole.table));
}

TEST_F(Study, RandomSweepsRepeatBySeed) {
  const std::string rest = R"("axes":[{"pointer":"/systems/0/stiffness","min":1,"max":1000,"scale":"log"}],
    "measure":["energy.total"],"mode":"random","draws":5,"horizon":0.1,"seed":)";
  const auto a = result_csv(run(with("sweep", rest + "3")).table),
             b = result_csv(run(with("sweep", rest + "3")).table);
  EXPECT_EQ(a, b);
  EXPECT_NE(a, result_csv(run(with("sweep", rest + "4")).table));
}

TEST_F(Study, RandomSweepsDrawEveryValueOfAList) {
  const auto table = run(with("sweep", R"("axes":[{"pointer":"/systems/0/stiffness","values":[100,200,300]}],
    "measure":["energy.total"],"mode":"random","draws":60,"horizon":0.1,"seed":1)"))
                         .table;
  std::map<double, int> drawn;
  for (const auto& row : table.rows) ++drawn[std::get<double>(row[1])];
  ASSERT_EQ(drawn.size(), 3u);
  // 20 each, with a standard deviation of 3.7.
  for (const auto& [value, times] : drawn) EXPECT_GT(times, 5) << value;
}

TEST_F(Study, CancellingEndsIt) {
  cancelled = true;
  try {
    run(with("convergence", ""));
    FAIL() << "a cancelled study went on";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), "cancelled");
  }
}

TEST(StudyRequest, FaultsNameTheirPlace) {
  const auto with_scene = [](const std::string& rest) {
    return std::string(R"({"scene":)") + kOscillator + rest + "}";
  };
  EXPECT_EQ(first_pointer("3"), "");
  EXPECT_EQ(first_pointer(with_scene("")), "/kind");
  EXPECT_EQ(first_pointer(with_scene(R"(,"kind":"convergense")")), "/kind");
  EXPECT_EQ(first_pointer(R"({"kind":"sweep"})"), "");
  EXPECT_EQ(first_pointer(R"({"kind":"sweep","gallery":"no such"})"), "/gallery");
  EXPECT_EQ(first_pointer(with_scene(R"(,"kind":"convergence","halvings":0)")), "/halvings");
  EXPECT_EQ(first_pointer(with_scene(R"(,"kind":"sweep","measure":["x"],"axes":[{"pointer":"/a"}])")),
            "/axes/0");
  EXPECT_EQ(
      first_pointer(R"({"kind":"convergence","scene":{"schema_version":"1.0","systems":[{"type":"x"}]}})"),
      "/scene/systems/0/type");
  EXPECT_EQ(first_pointer(with_scene(R"(,"kind":"convergence")")), "(accepted)");
}

}  // namespace
}  // namespace truestep
