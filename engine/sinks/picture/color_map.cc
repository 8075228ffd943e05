#include "engine/sinks/picture/color_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>

#include "engine/sinks/picture/color_stops.h"

namespace truestep::picture {
namespace {

constexpr Color rgb(uint32_t hex) {
  return {static_cast<float>((hex >> 16) & 255) / 255.0f, static_cast<float>((hex >> 8) & 255) / 255.0f,
          static_cast<float>(hex & 255) / 255.0f};
}

template <size_t N>
constexpr std::array<Color, N> colors_of(const uint32_t (&hex)[N]) {
  std::array<Color, N> out{};
  for (size_t i = 0; i < N; ++i) out[i] = rgb(hex[i]);
  return out;
}

constexpr auto kPalette = colors_of(kPaletteHex);
constexpr auto kViridis = colors_of(kViridisHex);
constexpr auto kWater = colors_of(kWaterHex);
constexpr auto kEmber = colors_of(kEmberHex);
constexpr auto kBalance = colors_of(kBalanceHex);
constexpr auto kSmoke = colors_of(kSmokeHex);
constexpr auto kSnow = colors_of(kSnowHex);
constexpr auto kSand = colors_of(kSandHex);
constexpr auto kViridisDark = colors_of(kViridisDarkHex);
constexpr auto kWaterDark = colors_of(kWaterDarkHex);
constexpr auto kEmberDark = colors_of(kEmberDarkHex);
constexpr auto kBalanceDark = colors_of(kBalanceDarkHex);
constexpr auto kSmokeDark = colors_of(kSmokeDarkHex);
constexpr auto kSandDark = colors_of(kSandDarkHex);
constexpr auto kNatural = colors_of(kNaturalHex);
static_assert(kNatural.size() == std::size(kNaturalNames));

std::span<const Color> stops(ColorMap map, Paper paper) {
  const auto either = [&](std::span<const Color> bright, std::span<const Color> dark) {
    return paper == Paper::dark ? dark : bright;
  };
  switch (map) {
    case ColorMap::water:
      return either(kWater, kWaterDark);
    case ColorMap::ember:
      return either(kEmber, kEmberDark);
    case ColorMap::balance:
      return either(kBalance, kBalanceDark);
    case ColorMap::smoke:
      return either(kSmoke, kSmokeDark);
    case ColorMap::snow:
      return kSnow;
    case ColorMap::sand:
      return either(kSand, kSandDark);
    case ColorMap::automatic:
    case ColorMap::viridis:
      break;
  }
  return either(kViridis, kViridisDark);
}

}  // namespace

Color palette(size_t i) {
  return kPalette[i % kPalette.size()];
}

Color color_of_kind(std::string_view name, size_t i) {
  for (size_t k = 0; k < kNatural.size(); ++k) {
    if (name == kNaturalNames[k]) return kNatural[k];
  }
  return palette(i);
}

Paper paper_of(const Color& background) {
  return background.r + background.g + background.b > 1.2f ? Paper::bright : Paper::dark;
}

Color ink_over(const Color& paper) {
  return paper_of(paper) == Paper::bright ? Color{0.17f, 0.21f, 0.28f} : Color{0.88f, 0.91f, 0.95f};
}

Color ink_on(ColorMap map, Paper paper) {
  const bool begins_dark = map == ColorMap::balance || map == ColorMap::smoke;
  return paper == Paper::dark && begins_dark ? Color{0.88f, 0.91f, 0.95f} : Color{0.08f, 0.09f, 0.12f};
}

Color map_color(ColorMap map, float t, Paper paper) {
  const std::span<const Color> s = stops(map, paper);
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
