// A mesh of a glTF document: its triangles, weights of skins and morph targets.
#pragma once
#include "engine/geometry/read/gltf/buffers.h"

namespace truestep::gltf {

/// All primitives as one; anything but triangles is a fault.
GltfMesh read_mesh(const Value& mesh, const Buffers& buffers);

}  // namespace truestep::gltf
