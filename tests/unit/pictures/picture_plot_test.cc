// Plots in pictures: axes with round values, names and units, curves distinguished by colour and a legend,
// and a camera that leaves room for the labels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/scene/gallery.h"
#include "engine/sinks/picture/camera.h"
#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/draw/draw_plot.h"
#include "engine/sinks/picture/draw/draw_world.h"
#include "engine/sinks/picture/draw/plot_ticks.h"
#include "tests/unit/pictures/picture_session.h"

namespace truestep {
namespace {

std::vector<std::string> texts(const DrawList& list, std::initializer_list<DrawLabel::Side> sides) {
  std::vector<std::string> out;
  for (const DrawLabel& l : list.labels) {
    if (std::find(sides.begin(), sides.end(), l.side) != sides.end()) out.push_back(l.text);
  }
  return out;
}
using Side = DrawLabel::Side;
using Texts = std::vector<std::string>;

std::string ode(const std::string& rest) {
  return R"({"schema_version": "1.0", "name": "plot", "gravity": [0, 0, 0], "time": {"dt": 0.1, "duration": 4},
    "systems": [{"type": "ode", "id": "o", )" +
         rest + "}]}";
}

TEST(PicturePlot, RoundValuesAreMultiplesOfOneTwoOrFive) {
  EXPECT_EQ(round_values(0, 1, 5), (std::vector<double>{0, 0.2, 0.4, 0.2 * 3, 0.8, 1}));
  EXPECT_EQ(round_values(-7, 12, 5), (std::vector<double>{-5, 0, 5, 10}));
  EXPECT_EQ(round_values(3, 3, 5).size(), 0u);
  EXPECT_EQ(tick_text(0.6000000000000001), "0.6");
  EXPECT_EQ(tick_text(-2.5e-7), "-2.5e-7");
  EXPECT_EQ(tick_text(200000), "2e5");
}

TEST(PicturePlot, AxesShowTheNamesThatTheSceneDrawsAndTheirValues) {
  const test::PictureSession s(
      ode(R"("states": {"y": 1}, "equations": {"y": "-y"}, "plot": ["t / 2 - 1", "3 * y"])"), 20);
  const DrawList list = s.list();
  EXPECT_EQ(texts(list, {Side::below}),
            (Texts{"0", "1", "2", "3", "4"}));  // the range of the whole run, not only of the past
  EXPECT_EQ(texts(list, {Side::corner}), Texts{"t (s)"});
  EXPECT_EQ(texts(list, {Side::above}), Texts{"y"});
  const Texts values = texts(list, {Side::left});
  EXPECT_TRUE(std::ranges::count(values, "1") == 1 && std::ranges::count(values, "3") == 0);
  for (const DrawLabel& l : list.labels) {
    if (l.side == Side::left && l.text == "1") {
      EXPECT_NEAR(l.at.y, 3, 1e-12);  // 3 y
    }
  }
  EXPECT_FALSE(list.ground_height);
  // Control: particles are no plot.
  const test::PictureSession other(
      R"({"schema_version": "1.0", "systems": [{"type": "particles", "id": "p", "positions": [[0, 1, 0]]}]})",
      0);
  EXPECT_TRUE(other.list().labels.empty());
}

TEST(PicturePlot, ALogarithmHasDecades) {
  const test::PictureSession s(
      ode(R"("states": {"y": 1}, "equations": {"y": "-3 * y"}, "plot": ["t", "log(y + 1e-9) / 5"])"), 40);
  const Texts values = texts(s.list(), {Side::left});
  ASSERT_GE(values.size(), 3u);
  EXPECT_TRUE(std::ranges::count(values, "0.01") == 1 || std::ranges::count(values, "0.1") == 1) << values[0];
}

TEST(PicturePlot, CurvesHaveColoursAndNames) {
  const test::PictureSession s(
      ode(R"("states": {"c": [1, 2, 3]}, "equations": {"c[i]": "-c[i]"}, "plot": ["t", "c[i]"])"), 20);
  const DrawList list = s.list();
  ASSERT_EQ(list.legend.size(), 3u);
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(list.legend[k].text, "c[" + std::to_string(k) + "]");
    EXPECT_EQ(list.legend[k].color.r, picture::palette(k).r);
  }
  // A single curve needs no legend.
  const test::PictureSession one(ode(R"("states": {"c": 1}, "equations": {"c": "-c"}, "plot": ["t", "c"])"),
                                 20);
  EXPECT_TRUE(one.list().legend.empty());
}

TEST(PicturePlot, TheSceneSaysPhasePlaneOrSpace) {
  const char* oscillator =
      R"("states": {"x": 1, "v": 0, "w": 1}, "equations": {"x": "v", "v": "-x", "w": "0"}, )";
  const DrawList plane =
      test::PictureSession(ode(std::string(oscillator) + R"("plot": ["x", "v"])"), 20).list();
  EXPECT_EQ(texts(plane, {Side::corner, Side::above}), (Texts{"x", "v"}));
  EXPECT_EQ(plane.fov_degrees, 12);
  const DrawList space =
      test::PictureSession(ode(std::string(oscillator) + R"("plot": ["x", "v", "w"])"), 20).list();
  EXPECT_EQ(texts(space, {Side::under, Side::above}), (Texts{"x", "v", "w"}));
  EXPECT_EQ(space.fov_degrees, 35);
}

// With a camera of the scene that is far too close, the frame is still in the picture.
TEST(PicturePlot, TheWholeFrameIsInThePicture) {
  std::string scene = ode(R"("states": {"y": 1}, "equations": {"y": "0"}, "plot": ["t", "y"])");
  scene.insert(scene.rfind('}'), R"(, "viewer": {"camera": {"eye": [0, 0, 2], "target": [0, 0, 0]}})");
  const DrawList list = test::PictureSession(scene, 20).list();
  const DrawCamera c = picture::camera_for(list, 1.6);
  ASSERT_FALSE(list.labels.empty());
  const double depth = c.eye.z, half = std::tan(c.fov_degrees * M_PI / 360) * depth;
  for (const DrawLabel& l : list.labels) {
    EXPECT_LT(std::abs(l.at.x - c.eye.x), 0.8 * 1.6 * half) << l.text;
    EXPECT_LT(std::abs(l.at.y - c.eye.y), 0.8 * half) << l.text;
  }
}

TEST(PicturePlot, ACurveOverARodHasItsLengthAndItsValue) {
  const test::PictureSession s(R"({"schema_version": "1.0", "time": {"dt": 0.001}, "gravity": [0, 0, 0],
    "systems": [{"type": "heat", "id": "rod", "cells": [40], "initial": "x"}]})",
                               1);
  const DrawList list = s.list();
  EXPECT_EQ(texts(list, {Side::corner}), Texts{"x (m)"});
  EXPECT_EQ(texts(list, {Side::above}), Texts{"value (K)"});
}

TEST(PicturePlot, WhatHasHardlyChangedIsNoLineOnTheEdge) {
  PlotBox flat, tall;
  for (const double y : {2.0, 2.1}) flat.add(Vec3{3 * y, y, 0});
  flat.add(Vec3{0, 2, 0});
  tall.add(Vec3{0, 0, 0}), tall.add(Vec3{1, 5, 0});
  flat.open_up(), tall.open_up();
  EXPECT_NEAR(flat.high.y - flat.low.y, (flat.high.x - flat.low.x) / 3, 1e-12);
  EXPECT_NEAR(flat.high.y + flat.low.y, 4.1, 1e-12) << "on both sides alike";
  EXPECT_EQ(tall.high.y - tall.low.y, 5) << "the control";
}

TEST(PicturePlot, ALegendNamesOnlyWhatHasItsColour) {
  const std::string net =
      R"("free": {"points": [[0, 0, 0], [1, 0, 0]], "masses": [1, 1], "springs": [{"a": 0, "b": 1,
    "stiffness": 1, "rest_length": 1}]}})";
  const std::string head = R"({"schema_version": "1.0", "time": {"dt": 0.01}, "systems": [)";
  const auto rope = [&](const std::string& id) {
    return R"({"type": "mass_spring", "id": ")" + id + "\", " + net;
  };
  const DrawList two = test::PictureSession(head + rope("left_rope") + ", " + rope("right") + "]}", 0).list();
  ASSERT_EQ(two.legend.size(), 2u);
  EXPECT_EQ(two.legend[0].text, "left rope");
  EXPECT_EQ(two.legend[1].color.r, picture::palette(1).r);
  // Bodies of one colour have a name, those of several have none.
  const std::string chain = R"({"type": "rod_chain", "id": "chain"})";
  const DrawList rods = test::PictureSession(head + rope("rope") + ", " + chain + "]}", 0).list();
  ASSERT_EQ(rods.legend.size(), 2u);
  EXPECT_EQ(rods.legend[1].text, "chain");
  EXPECT_EQ(rods.legend[1].color.r, picture::palette(1).r);
  const std::string balls = R"({"type": "rigid3d", "id": "balls", "bodies": [
    {"type": "sphere", "position": [0, 2, 0], "color": [1, 0, 0]}, {"type": "sphere", "position": [0, 5, 0]}]})";
  EXPECT_TRUE(test::PictureSession(head + rope("rope") + ", " + balls + "]}", 0).list().legend.empty());
}

// Both limbs are skins with colours of their own; by position in the palette the legend would swap them.
TEST(PicturePlot, ALegendHasTheColoursThatASceneGives) {
  const std::string limbs(find_gallery_scene("anim_twisted_limb")->text);
  const DrawList list = test::PictureSession(limbs, 0).list();
  ASSERT_EQ(list.legend.size(), 2u);
  EXPECT_EQ(list.legend[0].text, "linear");
  EXPECT_GT(list.legend[0].color.r, 2 * list.legend[0].color.b) << "orange";
  EXPECT_GT(list.legend[1].color.b, 2 * list.legend[1].color.r) << "blue";
  EXPECT_LT(picture::palette(0).r, 2 * picture::palette(0).b)
      << "control: the first place of the palette is blue";
}

}  // namespace
}  // namespace truestep
