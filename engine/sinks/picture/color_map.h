// Colours: palette of systems, scalar maps, and the sRGB transfer function (IEC 61966-2-1).
#pragma once
#include <cstdint>
#include <string_view>

#include "engine/sinks/picture/draw/draw_list.h"

namespace truestep::picture {

/// Default colour of the i-th system; repeats after eight.
Color palette(size_t i);

/// Colour of the i-th kind of something: its own if it is a material that people know, otherwise the
/// palette's.
Color color_of_kind(std::string_view name, size_t i);

/// What a background is: maps begin at another colour on dark paper.
enum class Paper : uint8_t { bright, dark };
Paper paper_of(const Color& background);

/// Colour of text and lines on a background of this colour: dark on bright, bright on dark.
Color ink_over(const Color& paper);

/// Colour of lines over a surface that a map colours.
Color ink_on(ColorMap map, Paper paper);

/// Colour of t in [0, 1] (clamped; not-a-number counts as 0), piecewise linear between the map's stops, which
/// differ on dark paper.
Color map_color(ColorMap map, float t, Paper paper);

/// sRGB component -> linear light, both in [0, 1].
float linear_from_srgb(float c);

}  // namespace truestep::picture
