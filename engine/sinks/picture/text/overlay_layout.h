// Where the text of a picture is: a caption at the bottom left, a legend at the top left, a colour bar at the
// bottom right, and labels beside things. None lies on another; names of things give way to the rest.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/sinks/picture/draw/draw_list.h"
#include "engine/sinks/picture/view.h"

namespace truestep::picture {

/// In pixels from the top left.
struct Rectangle {
  double left = 0, top = 0, right = 0, bottom = 0;
  bool meets(const Rectangle& o) const {
    return left < o.right && o.left < right && top < o.bottom && o.top < bottom;
  }
};

struct TextLine {
  std::string text;
  double x = 0, baseline = 0, capital = 0;  ///< pixels
  std::optional<Color> color = {};          ///< empty = the theme's ink

  Rectangle bounds() const;
};

/// A colour and its name.
struct LegendLine {
  Rectangle swatch;
  Color color;
  TextLine name;
};

struct ColorBar {
  DrawScale scale;
  Rectangle bar;
  TextLine label, low, high;
};

struct OverlayLayout {
  std::vector<TextLine> caption;
  std::vector<LegendLine> legend;
  std::optional<ColorBar> bar;
  std::vector<TextLine> labels;
  /// Around the caption, the legend and the bar, as far as they exist.
  std::vector<Rectangle> panels;
};

/// The scale that the list's colours need explaining by, if any.
std::optional<DrawScale> scale_of(const DrawList& list);

/// Without a view labels are left out.
OverlayLayout layout_overlay(const DrawList& list, const View* view, int width, int height);

}  // namespace truestep::picture
