// glTF 2.0 (Khronos 2017, ISO/IEC 12113): nodes with their poses, meshes with skin weights and morph targets,
// skins and animations, from a .glb (a container with a JSON chunk and a binary one) or a .gltf whose buffers
// are data URIs. Extensions that only say how surfaces look are passed over; a file that requires any other
// but KHR_mesh_quantization is refused. Not read: materials, cameras, compressed meshes, external files.
// Faults name the byte, or the JSON pointer into the file's document; what is wrong with something that
// nothing uses is no fault of the file: it is kept beside it.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "engine/geometry/shape.h"

namespace truestep {

class GltfFault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct GltfNode {
  std::string name;
  int32_t parent = -1, mesh = -1, skin = -1;
  Pose local;
  double scale = 1;   ///< uniform
  std::string fault;  ///< why its pose and scale cannot be used, with the place; empty: they can
};

struct GltfMesh {
  std::string name;
  std::vector<Vec3> positions;
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<std::array<uint32_t, 4>> joints;  ///< indices into the skin's joints; empty without a skin
  std::vector<std::array<double, 4>> weights;
  std::vector<std::vector<Vec3>> targets;  ///< offsets of the positions
  std::vector<std::string> target_names;   ///< empty, or one per target
  std::string fault;                       ///< why it cannot be used, with the place; empty: it can
};

struct GltfSkin {
  std::vector<uint32_t> joints;               ///< nodes
  std::vector<std::array<double, 16>> binds;  ///< inverse bind matrices, columns; empty: identity
  std::string fault;                          ///< why it cannot be used, with the place; empty: it can
};

struct GltfChannel {
  enum class Path : uint8_t { translation, rotation, scale, weights } path = Path::translation;
  enum class Between : uint8_t { linear, step, cubic } between = Between::linear;
  uint32_t node = 0;
  std::vector<double> times;
  std::vector<double> values;  ///< times (x 3 for cubic: slope in, value, slope out) x width
  size_t width = 3;
};
struct GltfAnimation {
  std::string name;
  std::vector<GltfChannel> channels;
  std::string fault;  ///< why it cannot be used, with the place; empty: it can
};

struct GltfModel {
  std::vector<GltfNode> nodes;  ///< in the file's order; no cycles
  std::vector<GltfMesh> meshes;
  std::vector<GltfSkin> skins;
  std::vector<GltfAnimation> animations;
};

/// Throws the fault that was kept beside something that is now to be used, if there is one.
inline void require_sound(const std::string& fault) {
  if (!fault.empty()) throw GltfFault(fault);
}

/// Bytes of a .glb, or the text of a .gltf. Throws GltfFault.
GltfModel read_gltf(std::span<const std::byte> bytes);
/// Lines as in a scene, broken anywhere: the text of a .gltf, or a .glb in base64. Throws GltfFault.
GltfModel read_gltf(std::span<const std::string> lines);

}  // namespace truestep
