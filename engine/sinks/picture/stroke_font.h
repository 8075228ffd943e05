// Text for pictures: a small font of our own made of strokes, drawn with smooth edges at any size.
#pragma once
#include <string_view>
#include <vector>

namespace truestep::picture {

/// Where a line of text goes; all in pixels.
struct TextPlace {
  double x;  ///< left edge of the first stroke
  double y;  ///< baseline
  double capital_height;
  double stroke;  ///< width of the pen
};

/// Width of `text` in pixels without the pen; characters that the font lacks count as '?'.
double text_width(std::string_view text, double capital_height);

/// width x height shares of each pixel that the text covers; what leaves the picture is cut off.
std::vector<float> text_coverage(std::string_view text, const TextPlace& place, int width, int height);

}  // namespace truestep::picture
