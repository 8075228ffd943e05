// Caption, labels, legend and colour bar, drawn into the finished pixels.
#pragma once
#include "engine/sinks/picture/view.h"

namespace truestep::picture {

/// RGBA bytes, top row first.
struct Canvas {
  uint8_t* rgba;
  int width, height;
};

/// Draws the list's labels at their positions, its caption bottom left, its legend top left and, bottom
/// right, the colour bar of the first set whose scalar has a label, or else that of the marks.
void draw_overlay(const DrawList& list, const View& view, Canvas canvas);

}  // namespace truestep::picture
