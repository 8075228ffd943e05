// The nodes of a glTF document: their parents and poses.
#pragma once
#include <vector>

#include "engine/geometry/read/gltf/value.h"

namespace truestep::gltf {

/// In the file's order, without meshes and skins; a cycle is a fault, a transform that is not a pose with a
/// uniform scale one of its node.
std::vector<GltfNode> read_nodes(const Value& document);

}  // namespace truestep::gltf
