// Descriptions of the outputs of the system type "rod_chain".
#include "engine/core/outputs.h"
#include "engine/systems/rod_chain/rod_chain.h"

namespace truestep::rod_chain {

const Outputs& rod_chain_outputs() {
  static const Outputs kOutputs{
      .rows = "a rod, from the anchor on",
      .fields = {{"position", "m", 3, "centre"},
                 {"velocity", "m/s", 3, "of the centre"},
                 {"direction", "1", 3, "unit vector along the rod"},
                 {"angular_velocity", "rad/s", 3, ""}},
      .observables = {{"energy.kinetic", "J", "of motion"},
                      {"energy.potential", "J", "of all forces that have one"},
                      {"energy.total", "J", "their sum"},
                      {"joints.gap", "m", "widest gap between ends that a joint joins"}}};
  return kOutputs;
}

}  // namespace truestep::rod_chain
