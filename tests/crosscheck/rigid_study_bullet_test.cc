// The cross-check study on rigid scenes: the other engine by itself, poses, statistics, faults with pointers.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "engine/scene/json/json.h"
#include "engine/studies/study.h"

namespace truestep {
namespace {

namespace json = boost::json;

class RigidStudy : public ::testing::Test {
 protected:
  StudyResult run(const std::string& extra, const std::string& system = R"("restitution_speed":0.05)") {
    const std::string request = R"({"kind":"cross_check","samples":10,)" + extra + R"("scene":{
      "name":"drop","time":{"dt":0.01,"duration":1},"systems":[{"type":"rigid3d","id":"r",)" +
                                system + R"(,"bodies":[{"type":"plane","motion":"fixed"},
      {"type":"box","position":[0,0.5,0],"velocity":[1,0,0]}]}]}})";
    return run_study(read_study_request(parse_json(request)), context_);
  }
  ThreadArena arena_{1};
  std::atomic<bool> cancelled_{false};
  StudyContext context_{arena_, cancelled_, [](double, const std::string&) {}};
};

double at(const json::object& o, std::string_view pointer) {
  return json::value(o).at_pointer(pointer).to_number<double>();
}

TEST_F(RigidStudy, TakesTheOtherEngineWhenNothingIsSaid) {
  const StudyResult r = run("");
  EXPECT_EQ(r.summary.at("b").at("engine").as_string(), "bullet");
  // A box slides and stops: a hundredth of a metre is its motion in one step.
  const double away = at(r.summary, "/poses/largest/position_largest");
  EXPECT_GT(away, 0);
  EXPECT_LT(away, 0.01);
  EXPECT_LT(at(r.summary, "/poses/largest/angle_largest"), 0.01);
  EXPECT_NEAR(at(r.summary, "/statistics/energy.potential/a/mean"),
              at(r.summary, "/statistics/energy.potential/b/mean"), 50);
  EXPECT_TRUE(r.summary.at("statistics").as_object().contains("penetration"));
  EXPECT_EQ(r.table.rows.size(), 11u);
  EXPECT_EQ(r.table.rows[0].size(), r.table.columns.size());
  // From the other engine's side.
  const StudyResult back = run("", R"("engine":"bullet")");
  EXPECT_EQ(back.summary.at("b").at("engine").as_string(), "truestep");
  EXPECT_NEAR(at(back.summary, "/poses/largest/position_largest"), away, 1e-12);
}

TEST_F(RigidStudy, AnEngineAgreesWithItself) {
  const StudyResult r = run(R"("a":{"engine":"bullet"},"b":{"engine":"bullet"},)");
  EXPECT_EQ(at(r.summary, "/poses/largest/position_largest"), 0);
  EXPECT_EQ(at(r.summary, "/statistics/energy.total/largest_difference"), 0);
}

TEST_F(RigidStudy, SaysWhatIsWrong) {
  const auto pointer = [&](const std::string& extra) -> std::string {
    try {
      run(extra);
    } catch (const Error& e) {
      return e.issues().empty() ? e.what() : e.issues()[0].pointer;
    }
    return "no error";
  };
  EXPECT_EQ(pointer(R"("b":{"engine":"box2d"},)"), "/b -> scene/systems/0/engine");
  EXPECT_EQ(pointer(R"("statistics":["energy.total","nonsense"],)"), "/statistics/1");
  EXPECT_EQ(pointer(R"("system":"other",)"), "/system");
}

}  // namespace
}  // namespace truestep
