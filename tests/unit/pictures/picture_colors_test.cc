// Colours say what they mean: kinds have names, deviations a middle, and every scene's own choice comes
// first.
#include <gtest/gtest.h>

#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/draw/draw_names.h"
#include "engine/sinks/picture/draw/trails.h"
#include "engine/sinks/picture/geometry.h"
#include "tests/unit/pictures/picture_session.h"

namespace truestep {
namespace {

std::string colored_scene(const std::string& systems, const std::string& viewer,
                          const std::string& more = "") {
  return R"({"schema_version": "1.0", "name": "t", "time": {"dt": 0.001, "duration": 1}, "gravity": [0, 0, 0], )" +
         more + R"("systems": [)" + systems + R"(], "viewer": )" + viewer + "}";
}

const char* kTwoMaterials =
    R"({"type": "mpm", "id": "both", "dimension": 2, "low": [0, 0, 0], "high": [1, 1, 0],
  "cell": 0.05, "bodies": [
  {"shape": "box", "center": [0.25, 0.5, 0], "half_extents": [0.1, 0.1, 1], "material": "fluid"},
  {"shape": "box", "center": [0.75, 0.5, 0], "half_extents": [0.1, 0.1, 1], "material": "sand"}]})";

TEST(PictureColors, MaterialsAreNamedInTheLegendNotOnABar) {
  const DrawList list =
      test::PictureSession(colored_scene(kTwoMaterials, R"({"color_by": "material"})"), 1).list();
  ASSERT_EQ(list.legend.size(), 2u);
  EXPECT_EQ(list.legend[0].text, "fluid");
  EXPECT_EQ(list.legend[1].text, "sand");
  for (const DrawPoints& set : list.points) EXPECT_TRUE(set.scalar_label.empty());
  const DrawPoints& both = list.points.front();
  const auto [low, high] = picture::scalar_range(both);
  const Color sand = picture::color_at(both, (4 - low) / (high - low), picture::Paper::bright);
  EXPECT_EQ(sand.r, picture::color_of_kind("sand", 4).r);
  EXPECT_NE(sand.r, picture::color_of_kind("fluid", 0).r);
}

TEST(PictureColors, AnotherFieldHasABar) {
  PictureLook look;
  look.color_by = "density";
  const DrawList list =
      test::PictureSession(colored_scene(kTwoMaterials, R"({"color_by": "material"})"), 1).list(look);
  EXPECT_TRUE(list.legend.empty());
  EXPECT_EQ(list.points.front().scalar_label, "density (kg/m^3)");
}

const char* kEddies = R"json({"type": "grid_fluid", "id": "flow", "cells": [16, 16], "size": [1, 1],
  "side": {"kind": "periodic"}, "initial": ["sin(2*pi*y)", "0.2*sin(2*pi*x) + 0.1*sin(4*pi*x)"]})json";

TEST(PictureColors, ADeviationIsAsFarToBothSidesOfZero) {
  const auto drawn = [](const std::string& viewer) {
    DrawList list = test::PictureSession(colored_scene(kEddies, viewer), 0).list();
    return list.points.front();
  };
  const DrawPoints vorticity = drawn(R"({"color_by": "vorticity"})");
  EXPECT_EQ(vorticity.color_map, ColorMap::balance);
  EXPECT_EQ(*vorticity.scalar_min, -*vorticity.scalar_max);
  // The scene's own map and range come first; an amount has neither.
  EXPECT_EQ(drawn(R"({"color_by": "vorticity", "color_map": "ember"})").color_map, ColorMap::ember);
  EXPECT_EQ(*drawn(R"({"color_by": "vorticity", "range": [-3, 5]})").scalar_max, 5);
  EXPECT_EQ(drawn(R"({"color_by": "speed"})").color_map, ColorMap::viridis);
}

const char* kThree = R"({"type": "nbody", "id": "bodies", "gravitational_constant": 1, "mass": 1,
  "positions": [[-1, 0, 0], [1, 0, 0], [0, 0, 0]], "velocities": [[0, 1, 0], [0, -1, 0], [0, 0, 1]], "draw_radius": 0.1})";

TEST(PictureColors, NamesDivideTheRange) {
  const DrawList list =
      test::PictureSession(
          colored_scene(kThree, R"({"color_by": "id", "names": ["first", "rest"], "range": [0, 2]})"), 0)
          .list();
  ASSERT_EQ(list.legend.size(), 2u);
  EXPECT_EQ(list.legend[1].text, "rest");
  EXPECT_THROW(parse_scene(colored_scene(kThree, R"({"names": ["first", "rest"]})")), Error);
}

TEST(PictureNames, ProbesNameWhatTheyWatch) {
  const std::string probes =
      R"("probes": [{"id": "the_sun", "system": "bodies", "index": 0}, {"id": "last", "system": "bodies", "index": -1}], )";
  const DrawList list =
      test::PictureSession(colored_scene(kThree, R"({"probe_labels": true})", probes), 0).list();
  ASSERT_EQ(list.labels.size(), 2u);
  EXPECT_EQ(list.labels[0].text, "the sun");
  EXPECT_EQ(list.labels[0].at.x, -1);
  EXPECT_EQ(list.labels[1].text, "last");
  EXPECT_EQ(list.labels[1].at.x, 0);
  EXPECT_TRUE(test::PictureSession(colored_scene(kThree, "{}", probes), 0).list().labels.empty());
}

TEST(PictureNames, TimesAreInTheUnitOfTheRun) {
  EXPECT_EQ(time_text(1.25, 8), "t = 1.250 s");
  EXPECT_EQ(time_text(31557600, 157680000), "t = 1.00 years");
  EXPECT_EQ(time_text(86400, 864000), "t = 1.00 days");
  EXPECT_EQ(time_text(1.2e-11, 3e-11), "t = 12.00 ps");
  EXPECT_EQ(time_text(0, 0), "t = 0.000 s");
}

TEST(PictureTrails, LeadToWhereThePointsAre) {
  test::PictureSession session(colored_scene(kThree, R"({"trail": 0.05})"), 0);
  const auto trails = TrailSink::of(session.session().world());
  ASSERT_TRUE(trails);
  session.session().add_sink(trails);
  PictureLook look;
  look.trails = trails;
  const size_t before = session.list(look).points.size();
  session.session().step(100);
  DrawList list = session.list(look);
  ASSERT_GT(list.points.size(), before);
  // The trail is 50 ms long at 1 m/s.
  float longest = 0;
  for (const DrawPoints& set : list.points) {
    for (size_t k = 0; k + 1 < set.lines.size() && !set.lines.empty(); k += 2)
      longest = std::max(longest, std::abs(set.positions[3 * set.lines[k] + 1]));
  }
  EXPECT_LT(longest, 0.11);
  EXPECT_GT(longest, 0.09);
  // Going back takes back what was later.
  session.session().reset();
  EXPECT_EQ(session.list(look).points.size(), before);
  EXPECT_FALSE(TrailSink::of(*std::make_shared<const World>(parse_scene(colored_scene(kThree, "{}")))));
}

}  // namespace
}  // namespace truestep
