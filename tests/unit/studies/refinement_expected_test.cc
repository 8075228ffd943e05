// Studies over resolution against numbers that a scene expects at its end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "engine/scene/json/json.h"
#include "engine/studies/study.h"

namespace truestep {
namespace {

/// A block of liquid of 40 kg (in the plane a metre thick) that falls for half a second: its momentum is
/// -40 g t = -196.2 kg m/s whatever the spacing.
std::string falling(const std::string& expected) {
  return R"j({"time":{"dt":0.01,"duration":0.5},"gravity":[0,-9.81,0],"systems":[{"type":"sph","id":"block","dimension":2,
    "precision":"f64","low":[-1,-4,0],"high":[1,1,1],"spacing":0.025,
    "bodies":[{"half_extents":[0.1,0.1,1]}]}],"expect":[)j" +
         expected + "]}";
}
constexpr const char* kMomentum =
    R"({"quantity":"block.momentum.y","equals":-218,"tolerance":1,"source":"a tenth too large"})";
constexpr const char* kOthers =
    R"j({"quantity":"block.momentum.x","equals":0,"tolerance":1,"source":"at rest"},
        {"quantity":"max(block.speed.max)","equals":77,"tolerance":1,"source":"not of the end alone"},
        {"quantity":"block.mass","max":1,"source":"not a number to equal"})j";

StudyResult study(const std::string& kind, const std::string& scene) {
  ThreadArena arena{1};
  std::atomic<bool> cancelled{false};
  StudyContext context{.arena = arena, .cancelled = cancelled, .progress = [](double, const std::string&) {}};
  return run_study(
      read_study_request(parse_json(R"({"refine":"both","quantity":"expect","halvings":3,"kind":")" + kind +
                                    R"(","scene":)" + scene + "}")),
      context);
}

size_t column(const StudyResult& r, const std::string& name) {
  for (size_t k = 0; k < r.table.columns.size(); ++k) {
    if (r.table.columns[k].name == name) return k;
  }
  return SIZE_MAX;
}

TEST(ExpectedRefinement, ErrorsAreDistancesFromWhatIsExpected) {
  const std::string scene = falling(std::string(kMomentum) + "," + kOthers);
  const auto r = study("convergence", scene);
  EXPECT_EQ(r.summary.at("measured_against").as_string(), "what the scene expects");
  EXPECT_EQ(r.summary.at("subject").as_string(), "block.spacing");
  ASSERT_GE(r.table.rows.size(), 3u);
  for (const auto& row : r.table.rows) {
    // 1 - 196.2 / 218 = 0.1 at every resolution, to rounding of many substeps.
    EXPECT_NEAR(std::get<double>(row[column(r, "error_end")]), 0.1, 1e-6);
  }
  // What takes no integrator has one curve.
  const auto w = study("work_precision", scene);
  EXPECT_EQ(w.plot.series.size(), 1u);
  ASSERT_GE(w.table.rows.size(), 3u);
  EXPECT_NEAR(std::get<double>(w.table.rows.back()[column(w, "error_end")]), 0.1, 1e-6);
}

TEST(ExpectedRefinement, NothingExpectedIsRefused) {
  try {
    study("convergence", falling(R"({"quantity":"block.mass","max":1,"source":"not a number to equal"})"));
    ADD_FAILURE() << "accepted";
  } catch (const Error& e) {
    ASSERT_EQ(e.issues().size(), 1u);
    EXPECT_EQ(e.issues()[0].pointer, "/quantity");
  }
}

}  // namespace
}  // namespace truestep
