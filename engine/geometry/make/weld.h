// Vertices at exactly the same place: files repeat corners at seams of their textures, or once a face.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

/// For every vertex the first one at its place.
std::vector<uint32_t> first_at_place(std::span<const Vec3> vertices);

}  // namespace truestep
