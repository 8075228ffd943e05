// Scenes that would take too long before their first step are refused with the estimate and the limit.
#include "engine/scene/admission.h"

#include <gtest/gtest.h>

#include "engine/scene/json/json.h"

namespace truestep {
namespace {

Cost cost_of_pool(const std::string& settle, const std::string& dt) {
  const auto scene = require_scene(read_scene(parse_json(
      R"({"time": {"dt": )" + dt + R"(}, "systems": [{"type": "sph", "id": "water", "low": [0, 0, 0],
          "high": [1, 1, 1], "spacing": 0.02, "settle": )" +
      settle + R"(, "bodies": [{"center": [0.5, 0.25, 0.5], "half_extents": [0.5, 0.25, 0.5]}]}]})")));
  return estimate(scene);
}

TEST(Admission, CountsWhatIsSteppedBeforeTheStart) {
  const Cost none = cost_of_pool("0", "0.01"), some = cost_of_pool("2", "0.01");
  EXPECT_EQ(none.start_seconds, 0);
  EXPECT_NEAR(some.start_seconds, 200 * some.seconds_per_step, 0.02 * some.start_seconds);
  EXPECT_NO_THROW(require_admission(some, {.start_seconds = 1.1 * some.start_seconds}));
  // A thousand seconds in steps of a microsecond would hold a server for years.
  try {
    require_admission(cost_of_pool("1000", "1e-6"), {});
    FAIL() << "was admitted";
  } catch (const Error& e) {
    ASSERT_EQ(e.issues().size(), 1u);
    EXPECT_NE(e.issues()[0].message.find("time before the first step"), std::string::npos);
  }
}

}  // namespace
}  // namespace truestep
