// Text for pictures: a small stroke font of our own, drawn with smooth edges at any size.
#pragma once
#include <string_view>
#include <vector>

namespace truestep::picture {

/// Position of a line of text; all in pixels.
struct TextPlace {
  double x;  ///< left edge of the first stroke
  double y;  ///< baseline
  double capital_height;
  double stroke;  ///< width of the pen
};

/// Width of `text` in pixels without the pen; characters missing in the font count as '?'.
double text_width(std::string_view text, double capital_height);

/// width x height coverages of the pixels by the text; anything outside the picture is cut off.
std::vector<float> text_coverage(std::string_view text, const TextPlace& place, int width, int height);

}  // namespace truestep::picture
