// glTF files: whatever the bytes are, they are read into a consistent model and converted to a motion, or
// refused with a sentence.
#include <cstddef>
#include <cstdint>

#include "engine/systems/skeleton/recording.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace truestep;
  try {
    const GltfModel model = read_gltf(std::as_bytes(std::span(data, size)));
    for (const GltfNode& n : model.nodes) {
      if (n.parent >= static_cast<int32_t>(model.nodes.size())) __builtin_trap();
      if (n.mesh >= static_cast<int32_t>(model.meshes.size())) __builtin_trap();
    }
    for (const GltfMesh& m : model.meshes) {
      for (const auto& t : m.triangles) {
        for (const uint32_t i : t) {
          if (i >= m.positions.size()) __builtin_trap();
        }
      }
      for (const auto& t : m.targets) {
        if (t.size() != m.positions.size()) __builtin_trap();
      }
    }
    const auto recording = skeleton::recording_of(model, "", 5);
    if (recording.turns.size() != recording.frames * recording.joints.size()) __builtin_trap();
    if (!model.skins.empty()) skeleton::skin_of(model, "");
  } catch (const GltfFault& fault) {
    if (fault.what()[0] == '\0') __builtin_trap();
  }
  return 0;
}
