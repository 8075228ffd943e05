// DrawLists shared by tests, the picture benchmark and visual inspection: a draped cloth, a fountain, a
// spring net, balls in a container. Positions come from formulas and a fixed-seed generator, so every run
// draws the same.
#pragma once
#include "engine/sinks/picture/draw/draw_list.h"

namespace truestep::test {

/// side x side cloth over a ball, triangles only.
DrawList draped_cloth(int side);
/// `count` particles of a fountain, coloured by speed.
DrawList fountain(int count);
/// Net with structural, shear and bending springs between two posts, a few pinned points.
DrawList spring_net(int side);
/// Balls of several sizes in a glass box with obstacles.
DrawList balls_in_box(int count);

}  // namespace truestep::test
