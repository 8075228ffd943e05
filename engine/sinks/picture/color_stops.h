// The colours of pictures and of the viewer, whose copy web/scripts/generate.mjs makes from this file: keep
// one table per line, in this form.
#pragma once
#include <cstdint>

namespace truestep::picture {

// clang-format off
// Systems without a colour of their own, in the order of the scene.
constexpr uint32_t kPaletteHex[] = {0x2f6fb7, 0xe0803a, 0x3a9d74, 0xc84b4b,
                                    0x8061b5, 0xd1a52b, 0x2ea3b0, 0xb9588f};

// Equally spaced stops; lightness is monotonic in all of them, so they survive a grey print.
constexpr uint32_t kViridisHex[] = {0x440154, 0x482878, 0x3e4a89, 0x31688e, 0x26828e,
                                    0x1f9e89, 0x35b779, 0x6dcd59, 0xb4de2c, 0xfde725};
constexpr uint32_t kWaterHex[] = {0x0b3c7d, 0x14599f, 0x1f78bd, 0x3c9ad2, 0x6dbbe3, 0xa6d9f0, 0xe4f5fc};
constexpr uint32_t kEmberHex[] = {0x3b0f2e, 0x6f1a3a, 0xa52c3a, 0xd54a2f, 0xf07c2a, 0xf9b04a, 0xfde6a0};
// clang-format on

}  // namespace truestep::picture
