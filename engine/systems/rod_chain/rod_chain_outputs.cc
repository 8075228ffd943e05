// Descriptions of the outputs of the system type "rod_chain".
#include "engine/core/outputs.h"
#include "engine/systems/rod_chain/rod_chain.h"

namespace truestep::rod_chain {

const Outputs& rod_chain_outputs() {
  static const Outputs kOutputs{
      .rows = "a rod, starting at the anchor",
      .fields = {{"position", "m", 3, "centre"},
                 {"velocity", "m/s", 3, "of the centre"},
                 {"direction", "1", 3, "unit vector along the rod"},
                 {"angular_velocity", "rad/s", 3, ""},
                 {"orientation", "1", 4, "quaternion (w, x, y, z) that turns the y axis along the rod"},
                 {"end", "m", 3, "part ends: of the rod, away from the anchor"},
                 {"end_velocity", "m/s", 3, "part ends"}},
      .observables = {{"energy.kinetic", "J", "of motion"},
                      {"energy.potential", "J", "of all conservative forces"},
                      {"energy.total", "J", "their sum"},
                      {"joints.gap", "m", "largest gap between the ends at a joint"}}};
  return kOutputs;
}

}  // namespace truestep::rod_chain
