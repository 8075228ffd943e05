// Scenes: any text gives a scene or an Error with a code; a scene that the parser accepts is written back as
// one that it accepts again, unchanged. A scene with a small cost estimate is built and stepped: it runs or
// gives a reason.
#include <boost/json/serialize.hpp>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "engine/scene/admission.h"
#include "engine/scene/json/json.h"
#include "engine/session/world/world.h"

namespace {

void step_twice(truestep::Scene scene) {
  const truestep::World world(std::move(scene));
  truestep::WorldState state = world.initial_state();
  truestep::Workspace workspace;
  const truestep::ThreadArena arena(1);
  for (int i = 0; i < 2; ++i) world.step(state, workspace, arena, {});
  (void)world.observe(state);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  constexpr truestep::AdmissionLimits kSmall{
      .memory_bytes = 4e6, .elements = 500, .seconds_per_step = 1e-3, .start_seconds = 0.1};
  try {
    auto scene = truestep::parse_scene({reinterpret_cast<const char*>(data), size});
    const auto once = scene.canonical();
    const auto again = truestep::require_scene(truestep::read_scene(once));
    if (boost::json::serialize(again.canonical()) != boost::json::serialize(once)) __builtin_trap();
    truestep::require_admission(truestep::estimate(scene), kSmall);
    step_twice(std::move(scene));
  } catch (const truestep::Error& error) {
    if (error.code().empty()) __builtin_trap();
  }
  return 0;
}
