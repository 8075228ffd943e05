// A run whose result is not trustworthy warns once, with a dt that would be. (That dt works:
// tests/scenes/fluids/whirls_are_told_of_their_step.json.)
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/scene/json/json.h"
#include "engine/session/session.h"

namespace truestep {
namespace {

// Eddies of 1 m/s on cells of 1/16 m; `cfl` lets a substep be as long as the step.
Session whirls(double dt) {
  const std::string scene = R"s({"schema_version":"1.0","name":"whirls","time":{"dt":)s" +
                            std::to_string(dt) +
                            R"s(,"duration":10},"systems":[{"type":"grid_fluid","id":"f","cells":[16,16],
    "side":{"kind":"periodic"},"advection":"maccormack","cfl":100,
    "initial":["sin(2*pi*x)*cos(2*pi*y)","-cos(2*pi*x)*sin(2*pi*y)"]}]})s";
  return Session(std::make_shared<const World>(parse_scene(scene)), std::make_shared<const ThreadArena>(1));
}

class Listener final : public Sink {
 public:
  bool due(uint64_t) override { return false; }
  const FrameRequest& request() const override { return request_; }
  void accept(const FramePtr&) override {}
  void notify(std::string_view kind, uint64_t, const std::string& detail) override {
    if (kind == "warning") told.push_back(detail);
  }
  std::vector<std::string> told;

 private:
  FrameRequest request_;
};

TEST(SessionWarnings, SaysOnceWhatIsWrong) {
  Session s = whirls(0.5);
  const auto listener = std::make_shared<Listener>();
  s.add_sink(listener);
  s.step(4);
  ASSERT_EQ(s.warnings().size(), 1u);
  const SessionWarning& w = s.warnings()[0];
  EXPECT_EQ(w.system, "f");
  EXPECT_EQ(w.warning.quantity, "cfl");
  EXPECT_EQ(w.first_step, 1u);
  EXPECT_GT(w.warning.value, w.warning.limit);
  ASSERT_GT(w.warning.suggested_dt, 0);
  EXPECT_THAT(listener->told,
              ::testing::ElementsAre(::testing::HasSubstr("system \"f\": the flow crosses ")));
}

TEST(SessionWarnings, BelongToThePastThatASeekLeadsTo) {
  Session s = whirls(0.5);
  s.step(2);
  ASSERT_FALSE(s.warnings().empty());
  s.seek(0);
  EXPECT_TRUE(s.warnings().empty());
  s.step(1);
  EXPECT_FALSE(s.warnings().empty());
  s.reset();
  EXPECT_TRUE(s.warnings().empty());
}

}  // namespace
}  // namespace truestep
