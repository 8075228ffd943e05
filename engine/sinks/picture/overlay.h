// Caption and colour bar, drawn into the finished pixels.
#pragma once
#include "engine/sinks/picture/draw_list.h"

namespace truestep::picture {

/// RGBA bytes, top row first.
struct Canvas {
  uint8_t* rgba;
  int width, height;
};

/// Draws the list's caption bottom left and, bottom right, the colour bar of the first set whose scalar has a
/// label.
void draw_overlay(const DrawList& list, Canvas canvas);

}  // namespace truestep::picture
