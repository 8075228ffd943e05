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
// From one side of zero to the other: as dark at both ends, palest in the middle.
constexpr uint32_t kBalanceHex[] = {0x1b3f7f, 0x2f6fb7, 0x7fb0d8, 0xc9dcea, 0xf4f2ee, 0xf0cdb9, 0xdf8f6b, 0xbd4a3c, 0x7d1731};
constexpr uint32_t kSmokeHex[] = {0xe9eef3, 0xc9cfd6, 0xa3aab3, 0x7d858f, 0x5a626c, 0x3d444d};
// Loose snow is white; packed, it is blue as ice.
constexpr uint32_t kSnowHex[] = {0xffffff, 0xf1f7fc, 0xd9e8f4, 0xb3d1e8, 0x84b3d6, 0x5590bf, 0x2f6a9c};
constexpr uint32_t kSandHex[] = {0x6b4a25, 0x8f6636, 0xb08449, 0xcda463, 0xe2c488, 0xf3e2b8};
// The same on dark paper: amounts begin where they can be told from it, deviations and smoke at its own colour.
constexpr uint32_t kViridisDarkHex[] = {0x7d5bbe, 0x6a71c8, 0x5287c9, 0x3e9bc4, 0x34acb6, 0x3bbd9f, 0x5ccb82, 0x8dd862, 0xc4e23c, 0xfde725};
constexpr uint32_t kWaterDarkHex[] = {0x2667b4, 0x2c79c4, 0x388dd1, 0x55a6dc, 0x7dc1e8, 0xaddcf2, 0xe8f7fd};
constexpr uint32_t kEmberDarkHex[] = {0xa84470, 0xc14a5b, 0xd65745, 0xe86f36, 0xf48f35, 0xfab751, 0xfde6a0};
constexpr uint32_t kBalanceDarkHex[] = {0x8cc4ff, 0x4f9be6, 0x3572b5, 0x2c4c74, 0x2a303a, 0x6a3d38, 0xad5344, 0xe07a58, 0xffb591};
constexpr uint32_t kSmokeDarkHex[] = {0x2a303a, 0x4a515c, 0x6f7782, 0x969ea8, 0xc0c7cf, 0xeef2f6};
constexpr uint32_t kSandDarkHex[] = {0x96693a, 0xa97a45, 0xbd9054, 0xd2aa6a, 0xe4c78d, 0xf4e4bc};
// Kinds that have a colour of their own, by their names.
constexpr const char* kNaturalNames[] = {"fluid", "water", "oil", "snow", "sand", "foam", "smoke", "ice", "Sun", "Mercury", "Venus", "Earth", "Mars", "Jupiter", "Saturn", "Uranus", "Neptune"};
constexpr uint32_t kNaturalHex[] = {0x2f86c9, 0x2f86c9, 0xd9a52b, 0xf4f9fd, 0xd8b06a, 0xe9c4a0, 0x7d858f, 0xb3d1e8, 0xf2b233, 0x9a8f86, 0xdfb06c, 0x3f7fd0, 0xc9552f, 0xbf8a58, 0xd6bd7c, 0x6fc0cd, 0x4463c9};
// clang-format on

}  // namespace truestep::picture
