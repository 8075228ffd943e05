// Text for pictures: outlines of DejaVu Sans, filled with the exact share of each pixel that they cover.
#pragma once
#include <string_view>
#include <vector>

namespace truestep::picture {

/// Position of a line of text; all in pixels.
struct TextPlace {
  double x;  ///< left edge
  double y;  ///< baseline
  double capital_height;
};

/// Width of `text` (UTF-8) in pixels; characters missing in the font count as '?'.
double text_width(std::string_view text, double capital_height);

/// width x height coverages of the pixels by the text; anything outside the picture is cut off.
std::vector<float> text_coverage(std::string_view text, const TextPlace& place, int width, int height);

/// What surrounds `coverage` by about `reach` pixels, fading outwards.
std::vector<float> halo_of(std::vector<float> coverage, int width, int height, double reach);

}  // namespace truestep::picture
