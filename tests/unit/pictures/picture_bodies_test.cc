// Bodies in pictures: a coloured body appears where it should and nowhere else; marks are drawn on top.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/collision/drawn_mesh.h"
#include "engine/sinks/picture/picture.h"

namespace truestep {
namespace {

using Kind = DrawShape::Kind;

struct RedPixels {
  int pixels = 0;
  double x = 0, y = 0;  ///< their middle
};

/// Pixels more red than the background.
RedPixels reds(const std::vector<uint8_t>& rgba, int width) {
  RedPixels c;
  for (size_t i = 0; i < rgba.size(); i += 4) {
    if (rgba[i] < rgba[i + 1] + 60) continue;
    const auto k = static_cast<int>(i / 4);
    ++c.pixels, c.x += k % width, c.y += k / width;
  }
  if (c.pixels > 0) c.x /= c.pixels, c.y /= c.pixels;
  return c;
}

DrawShape red(Kind kind, Vec3 size) {
  DrawShape s;
  s.kind = kind, s.size = size, s.color = Color{0.9f, 0.08f, 0.08f};
  if (kind == Kind::mesh) {
    std::vector<Vec3> cube;
    for (int k = 0; k < 8; ++k)
      cube.push_back({k & 1 ? size.x : -size.x, k & 2 ? size.y : -size.y, k & 4 ? size.z : -size.z});
    s.mesh = drawn_mesh(hull_solid(cube));
  }
  return s;
}

constexpr double kFar = 200;  // m; further away the opening would be under a degree

/// From far away, so that perspective hardly matters: 200 pixels are 4 m.
DrawList far(const DrawShape& s) {
  DrawList list;
  list.shapes = {s};
  list.camera = DrawCamera{{0, 0, kFar}, {}, {}, 2 * std::atan(2 / kFar) * 180 / M_PI};
  return list;
}

TEST(PictureBodies, EveryKindCoversItsArea) {
  PictureRenderer renderer(200, 200);
  const double metre = 50;  // pixels
  const struct {
    DrawShape shape;
    double area;
  } cases[] = {{red(Kind::box, {1, 0.5, 0.3}), 4 * 1 * 0.5},
               {red(Kind::mesh, {0.7, 0.9, 0.2}), 4 * 0.7 * 0.9},
               {red(Kind::cylinder, {0.5, 0.8, 0}), 4 * 0.5 * 0.8},
               {red(Kind::capsule, {0.4, 0.6, 0}), 4 * 0.4 * 0.6 + M_PI * 0.16},
               {red(Kind::sphere, {0.8, 0, 0}), M_PI * 0.64}};
  for (const auto& c : cases) {
    const RedPixels seen = reds(renderer.render_rgba(far(c.shape)), 200);
    const double pixels = c.area * metre * metre;
    // Edge pixels count or not: half a pixel along a border of some 4 sqrt(pixels).
    EXPECT_NEAR(seen.pixels, pixels, 2.5 * std::sqrt(pixels)) << static_cast<int>(c.shape.kind);
    EXPECT_NEAR(seen.x, 99.5, 1);
    EXPECT_NEAR(seen.y, 99.5, 1);
  }
}

TEST(PictureBodies, APoseMovesAndTurnsIt) {
  PictureRenderer renderer(200, 200);
  DrawShape s = red(Kind::cylinder, {0.2, 0.8, 0});
  s.position = {1, 0.6, 0};
  const RedPixels moved = reds(renderer.render_rgba(far(s)), 200);
  EXPECT_NEAR(moved.x, 99.5 + 50, 1);
  EXPECT_NEAR(moved.y, 99.5 - 30, 1);
  // A quarter turn about x shows the disk instead of the side.
  s.orientation[0] = s.orientation[1] = std::sqrt(0.5);
  const RedPixels turned = reds(renderer.render_rgba(far(s)), 200);
  EXPECT_NEAR(turned.pixels, M_PI * 0.04 * 2500, 60);
  EXPECT_GT(moved.pixels, 2 * turned.pixels);  // control
}

TEST(PictureBodies, MarksLieOverWhatWouldHideThem) {
  PictureRenderer renderer(200, 200);
  DrawList list = far(red(Kind::box, {1, 1, 1}));
  list.shapes[0].color = Color{0.5f, 0.5f, 0.5f};
  list.camera = DrawCamera{{0, 0, 10}, {}, {}, 30};
  EXPECT_EQ(reds(renderer.render_rgba(list), 200).pixels, 0);
  list.marks.push_back({{-0.5, 0, 0}, {0.5, 0, 0}, {0.95f, 0.05f, 0.05f}, 0.05});  // inside the box
  const RedPixels seen = reds(renderer.render_rgba(list), 200);
  const double metre = 100 / (10 * std::tan(15 * M_PI / 180));
  EXPECT_NEAR(seen.pixels, 0.1 * metre * metre, 40);  // an edge of 80 pixels, half of them counted
  // Control: the same line as a spring of the scene is hidden.
  DrawPoints points;
  points.positions = {-0.5f, 0, 0, 0.5f, 0, 0};
  points.lines = {0, 1}, points.line_radius = 0.05f, points.color = Color{0.95f, 0.05f, 0.05f};
  list.marks.clear();
  list.points.push_back(points);
  EXPECT_EQ(reds(renderer.render_rgba(list), 200).pixels, 0);
}

TEST(PictureBodies, AFloorThatIsIgnoredDoesNotMakeTheRestSmall) {
  PictureRenderer renderer(200, 200);
  DrawList list;
  list.shapes = {red(Kind::box, {0.5, 0.5, 0.5}), red(Kind::box, {50, 0.1, 50})};
  list.shapes[1].position = {0, -0.6, 0}, list.shapes[1].color = Color{0.6f, 0.6f, 0.6f};
  const int small = reds(renderer.render_rgba(list), 200).pixels;
  list.shapes[1].framing = DrawShape::Framing::ignored;
  EXPECT_GT(reds(renderer.render_rgba(list), 200).pixels, 50 * std::max(1, small));
}

}  // namespace
}  // namespace truestep
