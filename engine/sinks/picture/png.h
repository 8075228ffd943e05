// PNG out: 8-bit RGB, sRGB.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace truestep {

/// The PNG file of `rgba` (height x width x 4 bytes, top row first; alpha is dropped). Throws
/// Error("invalid_picture") when the sizes do not match, Error("png_failed") when libpng does.
std::vector<uint8_t> encode_png(std::span<const uint8_t> rgba, int width, int height);

}  // namespace truestep
