// Pixels of grids at places where the field is known: slices, volumes, level lines, arrows, streamlines,
// height fields and curves. A wrong range, layer or number of levels is seen.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>

#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/picture.h"
#include "tests/unit/pictures/picture_pixels.h"
#include "tests/unit/pictures/picture_session.h"

namespace truestep {
namespace {

constexpr int kSide = 480;
/// Pixels of a metre: the picture is 1.2 m wide, from so far away that a metre behind shrinks by a sixtieth.
constexpr double kMetre = kSide / 1.2, kFarAway = 60;

/// A picture along an axis, with the square or cube [0, 1] in its middle; nothing is written into it.
class GridPicture {
 public:
  GridPicture(DrawList list, const Vec3& middle, const Vec3& towards, const Vec3& up, const Vec3& right)
      : middle_(middle),
        up_(up),
        right_(right),
        background_(shown(DrawList(), towards)),
        pixels_(shown(std::move(list), towards)) {}
  static GridPicture front(const std::string& scene) {
    return {test::PictureSession(scene, 0).list(), {0.5, 0.5, 0}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
  }
  test::Rgb at(const Vec3& p) const { return pixel(pixels_, p); }
  test::Rgb behind(const Vec3& p) const { return pixel(background_, p); }
  /// The darkest of the pixels at most two away from p across a line that runs along x or y.
  test::Rgb ink_at(const Vec3& p) const {
    test::Rgb darkest{255, 255, 255};
    for (int dx = -2; dx <= 2; ++dx) {
      for (int dy = -2; dy <= 2; ++dy) {
        const test::Rgb c = at(p + right_ * (dx / kMetre) + up_ * (dy / kMetre));
        if (test::brightness(c) < test::brightness(darkest)) darkest = c;
      }
    }
    return darkest;
  }

 private:
  test::Pixels shown(DrawList list, const Vec3& towards) const {
    list.camera =
        DrawCamera{middle_ + towards * kFarAway, middle_, up_, 2 * std::atan(0.6 / kFarAway) * 180 / M_PI};
    list.ground_height.reset(), list.scale.reset();
    list.caption.clear(), list.labels.clear(), list.legend.clear();
    for (DrawPoints& p : list.points) p.scalar_label.clear();
    return PictureRenderer(kSide, kSide).render_rgba(list);
  }
  test::Rgb pixel(const test::Pixels& pixels, const Vec3& p) const {
    const Vec3 d = p - middle_;
    return test::at(pixels, kSide, static_cast<int>(std::lround(kSide / 2.0 + dot(d, right_) * kMetre - 0.5)),
                    static_cast<int>(std::lround(kSide / 2.0 - dot(d, up_) * kMetre - 0.5)));
  }

  Vec3 middle_, up_, right_;
  test::Pixels background_, pixels_;
};

std::array<double, 3> channels(const test::Rgb& c) {
  return {double(c.r), double(c.g), double(c.b)};
}
std::array<double, 3> map_channels(double t) {
  const Color c = picture::map_color(ColorMap::viridis, static_cast<float>(t), picture::Paper::bright);
  return {255.0 * c.r, 255.0 * c.g, 255.0 * c.b};
}
double color_gap(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  double most = 0;
  for (size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(a[c] - b[c]));
  return most;
}
double color_gap(const test::Rgb& c, double t) {
  return color_gap(channels(c), map_channels(t));
}
/// Largest distance of a channel from the colours of `value` at 25 places of the unit square.
double worst_gap(const GridPicture& picture, const std::function<double(double x, double y)>& value) {
  double most = 0;
  for (int i = 0; i < 25; ++i) {
    const double x = 0.1 + 0.2 * (i % 5), y = 0.1 + 0.2 * (i / 5);
    most = std::max(most, color_gap(picture.at({x, y, 0}), value(x, y)));
  }
  return most;
}
/// Two roundings to eight bits, the straight line of colours across a cell, and half a pixel.
constexpr double kSame = 6;
/// The viewer's ink is nearly black, the darkest colour of the map is not.
bool is_ink(const test::Rgb& c) {
  return std::max({c.r, c.g, c.b}) < 60;
}

std::string grid_heat(const std::string& cells, const std::string& initial, const std::string& viewer) {
  return R"({"time": {"dt": 0.001}, "gravity": [0, 0, 0], "viewer": {"color_by": "value", "labels": false, )" +
         viewer + R"(}, "systems": [{"type": "heat", "id": "g", "cells": )" + cells + R"(, "initial": ")" +
         initial + R"("}]})";
}

TEST(GridPixels, ASliceHasTheColoursOfItsValues) {
  const auto value = [](double x, double y) { return 0.5 * (x * x + y); };
  const auto drawn = [](const char* range) {
    return GridPicture::front(grid_heat("[60, 60]", "(x^2 + y)/2", std::string(R"("range": )") + range));
  };
  EXPECT_LT(worst_gap(drawn("[0, 1]"), value), kSame);
  EXPECT_LT(worst_gap(drawn("[-1, 1]"), [&](double x, double y) { return 0.5 * (value(x, y) + 1); }), kSame);
  EXPECT_GT(worst_gap(drawn("[0, 2]"), value), 10 * kSame) << "control";
  // Outside of the grid is background, and the outermost nodes are on its edge.
  const GridPicture edge = drawn("[0, 1]");
  EXPECT_LT(color_gap(channels(edge.at({1.01, 0.5, 0})), channels(edge.behind({1.01, 0.5, 0}))), 1);
  EXPECT_LT(color_gap(edge.at({0.99, 0.5, 0}), value(0.99, 0.5)), 2 * kSame);
}

TEST(GridPixels, ASliceOfAVolumeIsThatOfItsLayer) {
  const auto drawn = [](const char* at) {
    return GridPicture::front(
        grid_heat("[16, 16, 16]", "z*(x + y)/2",
                  std::string(R"("range": [0, 1], "slice": {"axis": "z", "at": )") + at + "}"));
  };
  const auto value = [](double x, double y) { return 0.75 * 0.5 * (x + y); };
  EXPECT_LT(worst_gap(drawn("0.75"), value), kSame);
  EXPECT_GT(worst_gap(drawn("0.25"), value), 10 * kSame) << "control";
}

TEST(GridPixels, AVolumeIsSeenThroughItsSlices) {
  // Five slices one behind another, the more transparent the lower the value.
  const auto drawn = [](const char* range) {
    return GridPicture::front(grid_heat("[16, 16, 4]", "x", std::string(R"("range": )") + range));
  };
  const GridPicture picture = drawn("[0, 1]"), other = drawn("[0, 2]");
  double control = 0;
  for (const double x : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    const Vec3 p{x, 0.4, 0};
    const double left = std::pow(1 - (0.03 + 0.47 * x), 5);
    std::array<double, 3> want{};
    for (size_t c = 0; c < 3; ++c) {
      const auto linear = [](double byte) {
        return picture::linear_from_srgb(static_cast<float>(byte / 255));
      };
      const double light =
          linear(map_channels(x)[c]) * (1 - left) + linear(channels(picture.behind(p))[c]) * left;
      want[c] = 255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055);
    }
    // Five layers, each rounded.
    EXPECT_LT(color_gap(channels(picture.at(p)), want), 3 * kSame) << x;
    control = std::max(control, color_gap(channels(other.at(p)), want));
  }
  EXPECT_GT(control, 9 * kSame);
}

TEST(GridPixels, LevelLinesAreWhereTheLevelsAre) {
  const auto drawn = [](int levels) {
    return GridPicture::front(
        grid_heat("[40, 40]", "x", R"("range": [0, 1], "contours": )" + std::to_string(levels)));
  };
  const GridPicture three = drawn(3), one = drawn(1);
  for (const double y : {0.15, 0.5, 0.85}) {
    for (const double x : {0.25, 0.5, 0.75}) {
      EXPECT_TRUE(is_ink(three.ink_at({x, y, 0}))) << x;
      EXPECT_EQ(is_ink(one.ink_at({x, y, 0})), x == 0.5) << "control " << x;
    }
    for (const double x : {0.125, 0.375, 0.625, 0.875})
      EXPECT_LT(color_gap(three.at({x, y, 0}), x), kSame) << x;
  }
}

std::string grid_flow(const std::string& cells, const std::string& u, const std::string& v,
                      const std::string& viewer) {
  return R"({"time": {"dt": 0.001}, "gravity": [0, 0, 0], "viewer": {"color_by": "velocity", "labels": false,
    "range": [0, 2])" +
         viewer + R"(}, "systems": [{"type": "grid_fluid", "id": "g", "cells": )" + cells +
         R"(, "side": {"kind": "slip"}, "initial": [")" + u + R"(", ")" + v + R"("]}]})";
}

TEST(GridPixels, ArrowsPointAlongTheVelocity) {
  // Around the middle: an arrow in every one of 10 x 10 cells, from its centre.
  const GridPicture picture =
      GridPicture::front(grid_flow("[10, 10]", "-sin(pi*x)*cos(pi*y)", "cos(pi*x)*sin(pi*y)", ""));
  constexpr double kCell = 0.1;
  size_t seen = 0, wrong = 0;
  for (int j = 0; j < 10; ++j) {
    for (int i = 0; i < 10; ++i) {
      const double x = kCell * (i + 0.5), y = kCell * (j + 0.5);
      const Vec3 v{-std::sin(M_PI * x) * std::cos(M_PI * y), std::cos(M_PI * x) * std::sin(M_PI * y), 0};
      const double length = 0.9 * kCell * norm(v) / 2;
      if (length * kMetre < 12) continue;
      const Vec3 centre{x, y, 0}, along = v / norm(v);
      ++seen;
      EXPECT_TRUE(is_ink(picture.ink_at(centre + along * (0.4 * length)))) << x << ' ' << y;
      wrong += is_ink(picture.ink_at(centre - along * (0.4 * length)));  // control: nothing behind the centre
    }
  }
  EXPECT_GT(seen, 40u);
  EXPECT_EQ(wrong, 0u);
  // Between the arrows the colour is that of the speed: 1 of 2 in the middle of a side.
  EXPECT_LT(color_gap(picture.at({0.5 * kCell, 0.5, 0}), 0.5 * std::abs(std::cos(M_PI * 0.05))), 3 * kSame);
}

TEST(GridPixels, StreamlinesFollowTheVelocity) {
  // Straight up, with walls that slip along x: lines from bottom to top, in even distances.
  std::string scene = grid_flow("[20, 20]", "0", "1", R"(, "streamlines": 5)");
  scene.replace(scene.find(R"("side": {"kind": "slip"})"), 24,
                R"("side": {"kind": "slip"}, "sides": {"y_min": {"kind": "periodic"}})");
  const GridPicture picture = GridPicture::front(scene);
  const auto ink_share = [&](double x) {
    int ink = 0;
    for (int k = 0; k < 80; ++k) ink += is_ink(picture.at({x, 0.1 + 0.01 * k, 0}));
    return ink / 80.0;
  };
  int lines = 0, between = 0;
  bool before = false;
  for (double x = 0.05; x < 0.95; x += 1 / kMetre) {
    const double share = ink_share(x);
    const bool line = share > 0.95;
    lines += line && !before, between += share < 0.05;
    before = line;
  }
  // As many as there is room for: one for each column of seeds.
  EXPECT_GE(lines, 2);
  EXPECT_LE(lines, 5);
  EXPECT_GT(between, 0.9 * 0.9 * kMetre - 8 * lines);
  EXPECT_LT(color_gap(picture.at({0.5, 0.5, 0}), 0.5), kSame);
  // Control: without them there are arrows, and no line goes through.
  scene.replace(scene.find(R"(, "streamlines": 5)"), 18, "");
  const GridPicture arrows = GridPicture::front(scene);
  for (double x = 0.05; x < 0.95; x += 1 / kMetre) {
    int ink = 0;
    for (int k = 0; k < 80; ++k) ink += is_ink(arrows.at({x, 0.1 + 0.01 * k, 0}));
    EXPECT_LT(ink, 70) << x;
  }
}

/// Degrees: what light and shade leave of a colour.
double hue_of(const std::array<double, 3>& c) {
  return std::atan2(std::sqrt(3.0) * (c[1] - c[2]), 2 * c[0] - c[1] - c[2]) * 180 / M_PI;
}
double hue_gap(double a, double b) {
  return std::abs(std::remainder(a - b, 360));
}

TEST(GridPixels, AHeightFieldRisesByItsValues) {
  // Seen along y: the value x is at the height x, from the front edge to the back.
  const auto drawn = [](const char* height) {
    return GridPicture(
        test::PictureSession(
            grid_heat("[40, 40]", "x*y", std::string(R"("range": [0, 1], "height": )") + height), 0)
            .list(),
        {0.5, 0.5, 0.5}, {0, -1, 0}, {0, 0, 1}, {1, 0, 0});
  };
  const GridPicture picture = drawn("1"), lower = drawn("0.5");
  for (const double x : {0.2, 0.4, 0.6, 0.8, 0.95}) {
    for (const double share : {0.15, 0.5, 0.9}) {
      const Vec3 p{x, 0, share * x};
      EXPECT_GT(color_gap(channels(picture.at(p)), channels(picture.behind(p))), 25) << x << ' ' << share;
      EXPECT_LT(hue_gap(hue_of(channels(picture.at(p))), hue_of(map_channels(share * x))), 15)
          << x << ' ' << share;
    }
    const Vec3 above{x, 0, x + 0.02};
    EXPECT_LT(color_gap(channels(picture.at(above)), channels(picture.behind(above))), 1) << x;
    const Vec3 top{x, 0, 0.9 * x};  // control
    EXPECT_LT(color_gap(channels(lower.at(top)), channels(lower.behind(top))), 1) << x;
  }
}

TEST(GridPixels, ACurveRunsThroughItsValues) {
  const auto picture =
      GridPicture::front(grid_heat("[64]", "sin(pi*x)", R"("range": [0, 1], "height": 0.5)"));
  for (const double x : {0.1, 0.3, 0.7, 0.9}) {  // beside the axes' lines
    const double value = std::sin(M_PI * x);
    const test::Rgb there = picture.at({x, 0.5 * value, 0});
    EXPECT_LT(hue_gap(hue_of(channels(there)), hue_of(map_channels(value))), 15) << x;
    const Vec3 off{x, 0.5 * value - 0.03, 0};  // control
    EXPECT_LT(color_gap(channels(picture.at(off)), channels(picture.behind(off))), 1) << x;
  }
}

TEST(GridPixels, AGridOfCellsFillsItsBox) {
  // Upwards at 2 x between periodic sides, in ten cells a side: the outermost centres are 0.05 m inside.
  const auto drawn = [](const std::string& more) {
    std::string scene = grid_flow("[10, 10]", "0", "2*x", more);
    scene.replace(scene.find(R"("side": {"kind": "slip"})"), 24,
                  R"("side": {"kind": "slip"}, "sides": {"y_min": {"kind": "periodic"}})");
    return GridPicture::front(scene);
  };
  const GridPicture picture = drawn(R"(, "contours": 3)");
  for (const double y : {0.01, 0.31, 0.99}) {
    // Beyond the outermost centres the colour is theirs.
    EXPECT_LT(color_gap(picture.at({0.01, y, 0}), 0.05), kSame) << y;
    EXPECT_LT(color_gap(picture.at({0.99, y, 0}), 0.95), kSame) << y;
    EXPECT_LT(color_gap(picture.at({0.6, y, 0}), 0.6), kSame) << y;
    EXPECT_TRUE(is_ink(picture.ink_at({0.5, y, 0}))) << "level lines go to the edges: " << y;
  }
  for (const Vec3& outside :
       {Vec3{-0.01, 0.3, 0}, Vec3{1.01, 0.3, 0}, Vec3{0.6, -0.01, 0}, Vec3{0.6, 1.01, 0}})
    EXPECT_LT(color_gap(channels(picture.at(outside)), channels(picture.behind(outside))), 1);
  // Streamlines cross the margin, up to their last step of half a cell.
  const GridPicture lines = drawn(R"(, "streamlines": 5)");
  size_t at_edges = 0;
  for (double x = 0.05; x < 0.95; x += 1 / kMetre)
    at_edges += is_ink(lines.at({x, 0.04, 0})) && is_ink(lines.at({x, 0.96, 0}));
  EXPECT_GE(at_edges, 2u);
  // In one dimension the curve does.
  const auto curve = GridPicture::front(
      R"({"time": {"dt": 0.001}, "viewer": {"color_by": "surface", "labels": false, "range": [0, 1], "height": 0.5},
          "systems": [{"type": "heightfield_wave", "id": "g", "cells": [10], "surface": "1"}]})");
  for (const double x : {0.02, 0.45, 0.98}) {
    EXPECT_LT(hue_gap(hue_of(channels(curve.at({x, 0.5, 0}))), hue_of(map_channels(1))), 15) << x;
    EXPECT_LT(color_gap(channels(curve.at({x, 0.45, 0})), channels(curve.behind({x, 0.45, 0}))), 1)
        << "control: nothing below " << x;
  }
}

}  // namespace
}  // namespace truestep
