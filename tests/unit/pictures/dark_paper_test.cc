// On dark paper: colour maps begin where they can be told from it, deviations and smoke at its colour; what
// is a few pixels thick is told from it, whatever its own colour.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/picture.h"
#include "tests/unit/pictures/picture_pixels.h"
#include "tests/unit/pictures/picture_session.h"

namespace truestep {
namespace {

double luminance(const Color& c) {
  using picture::linear_from_srgb;
  return 0.2126 * linear_from_srgb(c.r) + 0.7152 * linear_from_srgb(c.g) + 0.0722 * linear_from_srgb(c.b);
}

/// As of the Web Content Accessibility Guidelines: 1 for equal colours, 21 for black on white.
double contrast(const Color& a, const Color& b) {
  const double x = luminance(a) + 0.05, y = luminance(b) + 0.05;
  return std::max(x, y) / std::min(x, y);
}

Color dark_paper() {
  PictureLook look;
  look.theme = PictureLook::Theme::dark;
  const char* scene =
      R"({"schema_version": "1.0", "systems": [{"type": "particles", "id": "p", "positions": [[0, 0, 0]]}]})";
  return test::PictureSession(scene, 0).list(look).background_bottom;
}

TEST(DarkPaper, EveryAmountIsToldFromDarkPaper) {
  const Color paper = dark_paper();
  ASSERT_EQ(picture::paper_of(paper), picture::Paper::dark);
  double least_of_bright = 21;
  for (const ColorMap map :
       {ColorMap::viridis, ColorMap::water, ColorMap::ember, ColorMap::snow, ColorMap::sand}) {
    for (int k = 0; k <= 40; ++k) {
      const auto t = static_cast<float>(k) / 40;
      EXPECT_GT(contrast(picture::map_color(map, t, picture::Paper::dark), paper), 2.45)
          << static_cast<int>(map) << " at " << t;
      least_of_bright =
          std::min(least_of_bright, contrast(picture::map_color(map, t, picture::Paper::bright), paper));
    }
  }
  EXPECT_LT(least_of_bright, 1.2);  // the colours for bright paper begin invisibly
}

TEST(DarkPaper, NothingIsTheColourOfThePaper) {
  const Color dark = dark_paper(), bright = DrawList{}.background_bottom;
  const auto at = [](ColorMap map, float t, const Color& paper) {
    return contrast(picture::map_color(map, t, picture::paper_of(paper)), paper);
  };
  for (const Color& paper : {dark, bright}) {
    EXPECT_LT(at(ColorMap::balance, 0.5f, paper), 1.5);
    EXPECT_LT(at(ColorMap::smoke, 0, paper), 1.5);
    for (const auto& [map, t] :
         {std::pair{ColorMap::balance, 0.0f}, {ColorMap::balance, 1.0f}, {ColorMap::smoke, 1.0f}})
      EXPECT_GT(at(map, t, paper), 4.5);
  }
}

/// Whether luminance only grows or only falls from one t to another.
bool monotonic(ColorMap map, picture::Paper paper, float from, float to) {
  int up = 0, down = 0;
  for (int k = 0; k < 60; ++k) {
    const auto at = [&](int i) {
      return luminance(picture::map_color(map, from + (to - from) * static_cast<float>(i) / 60, paper));
    };
    ++(at(k + 1) > at(k) ? up : down);
  }
  return up == 0 || down == 0;
}

TEST(DarkPaper, LightnessSaysTheValueOnEveryPaper) {
  for (const auto paper : {picture::Paper::bright, picture::Paper::dark}) {
    for (const ColorMap map : {ColorMap::viridis, ColorMap::water, ColorMap::ember, ColorMap::smoke,
                               ColorMap::snow, ColorMap::sand})
      EXPECT_TRUE(monotonic(map, paper, 0, 1)) << static_cast<int>(map);
    EXPECT_TRUE(monotonic(ColorMap::balance, paper, 0, 0.5f));
    EXPECT_TRUE(monotonic(ColorMap::balance, paper, 0.5f, 1));
    EXPECT_FALSE(monotonic(ColorMap::balance, paper, 0, 1));
  }
}

TEST(DarkPaper, LinesOverASurfaceAreToldFromIt) {
  // Between the colours that most values have: an amount's first half, what is near zero of a deviation.
  for (const auto paper : {picture::Paper::bright, picture::Paper::dark}) {
    for (const ColorMap map : {ColorMap::balance, ColorMap::smoke, ColorMap::snow, ColorMap::sand})
      EXPECT_GT(contrast(picture::ink_on(map, paper),
                         picture::map_color(map, map == ColorMap::balance ? 0.5f : 0.2f, paper)),
                3);
  }
  for (const ColorMap map : {ColorMap::viridis, ColorMap::water, ColorMap::ember})
    EXPECT_GT(contrast(picture::ink_on(map, picture::Paper::dark),
                       picture::map_color(map, 0, picture::Paper::dark)),
              3);
}

constexpr int kPixels = 400, kAlong = 10;  // pixels; along a side of the picture

/// A hundred short lines, or points, of colours from black to the palest, each in a cell of its own.
DrawList hundred(bool points, bool exact) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> share(0, 1);
  DrawList list;
  list.background_top = list.background_bottom = dark_paper();
  list.camera =
      DrawCamera{{0.5 * kAlong, 0.5 * kAlong, 100}, {0.5 * kAlong, 0.5 * kAlong, 0}, Vec3{0, 1, 0}, 5.724};
  for (int k = 0; k < kAlong * kAlong; ++k) {
    DrawPoints& set = list.points.emplace_back();
    const float brightest = share(random), x = static_cast<float>(k % kAlong),
                y = static_cast<float>(k / kAlong);
    set.color = Color{brightest * share(random), brightest * share(random), brightest * share(random)};
    set.positions = {x + 0.3f, y + 0.5f, 0, x + 0.7f, y + 0.5f, 0};
    set.exact_lines = exact;
    if (points) {
      set.point_pixels = 8;
    } else {
      set.lines = {0, 1}, set.line_pixels = 5;
    }
  }
  return list;
}

/// Least contrast with the paper of what is brightest in each cell.
double least_contrast(const DrawList& list) {
  const test::Pixels pixels = PictureRenderer(kPixels, kPixels).render_rgba(list);
  double least = 21;
  for (int cell = 0; cell < kAlong * kAlong; ++cell) {
    double most = 1;
    for (int k = 0; k < kPixels * kPixels / (kAlong * kAlong); ++k) {
      const int side = kPixels / kAlong;
      const test::Rgb c =
          test::at(pixels, kPixels, cell % kAlong * side + k % side, cell / kAlong * side + k / side);
      const Color seen{static_cast<float>(c.r) / 255, static_cast<float>(c.g) / 255,
                       static_cast<float>(c.b) / 255};
      if (luminance(seen) > luminance(list.background_bottom))
        most = std::max(most, contrast(seen, list.background_bottom));
    }
    least = std::min(least, most);
  }
  return least;
}

TEST(DarkPaper, WhatIsThinIsToldFromIt) {
  // 3 : 1, less the rounding to eight bits.
  EXPECT_GT(least_contrast(hundred(false, false)), 2.95);
  EXPECT_GT(least_contrast(hundred(true, false)), 2.95);
  EXPECT_LT(least_contrast(hundred(false, true)), 1.2);  // lines that keep their colour
}

}  // namespace
}  // namespace truestep
