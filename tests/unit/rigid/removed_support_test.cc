// A sleeping body falls when what it lies on is removed, whichever of the two came first in the scene.
#include <gtest/gtest.h>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

using testing_coupled::SceneRun;

/// Heights of the upper of two boxes, at rest and a second after the lower one was removed.
struct Heights {
  double awake, before, after;
};
Heights heights(const std::string& type, bool upper_first) {
  const auto body = [&](double y, const std::string& half, const std::string& more) {
    const std::string box = R"("type": "box", "half_extents": )" + half;
    return "{" + (type == "rigid2d" ? R"("shapes": [{)" + box + "}]" : box) + R"(, "position": [0, )" +
           std::to_string(y) + ", 0]" + more + "}";
  };
  const std::string low = body(0.25, "[0.5, 0.25, 0.5]", ""), high = body(0.75, "[0.5, 0.25, 0.5]", "");
  SceneRun run(R"({"systems": [{"type": ")" + type + R"(", "id": "b", "bodies": [)" +
               (upper_first ? high + ", " + low : low + ", " + high) + ", " +
               body(-1, "[50, 1, 50]", R"(, "motion": "fixed")") + "]}]}");
  const auto height = [&](size_t row) {
    const State& s = run.session.state().systems[0];
    return load3(s.f64(s.at("position")).data(), row).y;
  };
  const size_t low_row = upper_first ? 1 : 0;
  run.session.step(180);
  const double awake = run.observe("b.awake"), before = height(1 - low_row);
  Command remove;
  remove.kind = CommandKind::remove, remove.system = "b", remove.index = static_cast<int64_t>(low_row);
  run.session.command(remove);
  run.session.step(60);
  // In space, rows close up behind removed ones.
  return {awake, before, height(type == "rigid3d" ? 0 : 1 - low_row)};
}

TEST(RemovedSupport, WakesWhatLiesOnIt) {
  for (const char* type : {"rigid2d", "rigid3d"}) {
    for (const bool upper_first : {false, true}) {
      const Heights h = heights(type, upper_first);
      EXPECT_EQ(h.awake, 0) << type << ", control";
      EXPECT_NEAR(h.before, 0.75, 0.01) << type;
      EXPECT_NEAR(h.after, 0.25, 0.01) << type << (upper_first ? ", upper one first" : ", lower one first");
    }
  }
}

}  // namespace
}  // namespace truestep
