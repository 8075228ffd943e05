// The nodes of a glTF document: their parents and their places.
#pragma once
#include <vector>

#include "engine/geometry/read/gltf/value.h"

namespace truestep::gltf {

/// In the file's order, without meshes and skins; a cycle, or a place that no pose and one scale make, is a
/// fault.
std::vector<GltfNode> read_nodes(const Value& document);

}  // namespace truestep::gltf
