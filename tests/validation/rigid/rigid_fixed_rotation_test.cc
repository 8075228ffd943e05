// No command turns a body with fixed_rotation. (That nothing else does is in tests/scenes/rigid.)
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "engine/session/world/world.h"

namespace truestep {
namespace {

TEST(FixedRotation, NoCommandGivesItAnAngularVelocity) {
  for (const std::string& body :
       {std::string(R"("rigid2d", "bodies": [{"shapes": [{"type": "box"}])"),
        std::string(R"("rigid3d", "bodies": [{"type": "box", "half_extents": [0.5, 0.5, 0.5])")}) {
    for (const bool fixed : {true, false}) {
      const World world(parse_scene(R"({"systems": [{"id": "r", "type": )" + body +
                                    R"(, "fixed_rotation": )" + (fixed ? "true" : "false") + "}]}]}"));
      WorldState state = world.initial_state();
      Command c;
      c.kind = CommandKind::set_parameter, c.system = "r", c.index = 0, c.name = "angular_velocity",
      c.value = 1, c.vector = {0, 0, 1};
      if (fixed) {
        EXPECT_THROW(world.apply(state, c), Error) << body;
      } else {
        EXPECT_NO_THROW(world.apply(state, c)) << body << ": the control";
      }
    }
  }
}

}  // namespace
}  // namespace truestep
