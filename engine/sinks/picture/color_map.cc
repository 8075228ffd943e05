#include "engine/sinks/picture/color_map.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace truestep::picture {
namespace {

constexpr Color rgb(int hex) {
  return {static_cast<float>((hex >> 16) & 255) / 255.0f, static_cast<float>((hex >> 8) & 255) / 255.0f,
          static_cast<float>(hex & 255) / 255.0f};
}

constexpr Color kPalette[] = {rgb(0x2f6fb7), rgb(0xe0803a), rgb(0x3a9d74), rgb(0xc84b4b),
                              rgb(0x8061b5), rgb(0xd1a52b), rgb(0x2ea3b0), rgb(0xb9588f)};

// Stops at equal distances; lightness grows monotonically in all of them, so they survive a grey print.
constexpr Color kViridis[] = {rgb(0x440154), rgb(0x482878), rgb(0x3e4a89), rgb(0x31688e), rgb(0x26828e),
                              rgb(0x1f9e89), rgb(0x35b779), rgb(0x6dcd59), rgb(0xb4de2c), rgb(0xfde725)};
constexpr Color kWater[] = {rgb(0x0b3c7d), rgb(0x14599f), rgb(0x1f78bd), rgb(0x3c9ad2),
                            rgb(0x6dbbe3), rgb(0xa6d9f0), rgb(0xe4f5fc)};
constexpr Color kEmber[] = {rgb(0x3b0f2e), rgb(0x6f1a3a), rgb(0xa52c3a), rgb(0xd54a2f),
                            rgb(0xf07c2a), rgb(0xf9b04a), rgb(0xfde6a0)};

std::span<const Color> stops(ColorMap map) {
  switch (map) {
    case ColorMap::water:
      return kWater;
    case ColorMap::ember:
      return kEmber;
    case ColorMap::viridis:
      break;
  }
  return kViridis;
}

}  // namespace

Color palette(size_t i) {
  return kPalette[i % std::size(kPalette)];
}

Color map_color(ColorMap map, float t) {
  const std::span<const Color> s = stops(map);
  const float last = static_cast<float>(s.size() - 1);
  const float x = t > 0 ? std::min(t, 1.0f) * last : 0.0f;
  const size_t i = std::min(static_cast<size_t>(x), s.size() - 2);
  const float f = x - static_cast<float>(i);
  const auto mix = [f](float a, float b) { return a + (b - a) * f; };
  return {mix(s[i].r, s[i + 1].r), mix(s[i].g, s[i + 1].g), mix(s[i].b, s[i + 1].b)};
}

float linear_from_srgb(float c) {
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

}  // namespace truestep::picture
