// Values of elements and joints in pictures: triangles, lines and marks have the colours of what they belong
// to, a bar explains them, and what nothing drawn can show is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/sinks/picture/color_map.h"
#include "engine/sinks/picture/picture.h"
#include "tests/support/part_systems.h"
#include "tests/unit/pictures/picture_pixels.h"
#include "tests/unit/pictures/picture_session.h"

namespace truestep {
namespace {

/// A square at rest in [0, 1] and one in [2, 3] that is stretched to [2, 3.5]: J = 1 and 1.5.
std::string squares(const std::string& viewer, const std::string& element = "quad4") {
  const std::string cells =
      element == "quad4" ? "[0, 1, 2, 3, 4, 5, 6, 7]" : "[0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7]";
  return R"({"schema_version": "1.0", "time": {"dt": 0.1}, "gravity": [0, 0, 0], "viewer": {)" + viewer +
         R"(}, "systems": [{"type": "fem", "id": "s", "motion": "quasi_static", "plane": "strain",
      "element": ")" +
         element + R"(", "mesh": {"cells": )" + cells + R"(, "vertices": [[0, 0, 0], [1, 0, 0], [1, 1, 0],
        [0, 1, 0], [2, 0, 0], [3, 0, 0], [3, 1, 0], [2, 1, 0]]},
      "sets": [{"name": "still", "high": [1.5, 2, 1]}, {"name": "pulled", "low": [1.5, -1, -1]}],
      "holds": [{"on": "still"}, {"on": "pulled", "x": "X/2-1", "y": "0"}]}]})";
}

/// The middles of both squares, seen from far in front of them.
std::array<test::Rgb, 2> middles(DrawList list) {
  list.camera = DrawCamera{{1.6, 0.5, 8}, {1.6, 0.5, 0}, {}, 35};
  list.ground_height.reset();
  PictureRenderer renderer(320, 160);
  const auto pixels = renderer.render_rgba(list);
  const double metre = 80 / (8 * std::tan(17.5 * M_PI / 180));  // pixels
  const auto at = [&](double x) {
    return test::at(pixels, 320, static_cast<int>(160 + (x - 1.6) * metre), 80);
  };
  return {at(0.5), at(2.75)};
}

bool violet(const test::Rgb& c) {
  return c.b > c.g + 30 && c.r > c.g;
}
bool yellow(const test::Rgb& c) {
  return c.r > c.b + 60 && c.g > c.b + 60;
}

TEST(ElementColours, NeighboursThatShareCornersDiffer) {
  const auto halves = [](std::vector<float> values) {
    DrawList list;
    DrawPoints& p = list.points.emplace_back();
    p.positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    p.triangles = {0, 1, 2, 0, 2, 3};
    p.triangle_scalar = std::move(values);
    list.camera = DrawCamera{{0.5, 0.5, 3}, {0.5, 0.5, 0}, {}, 35};
    const auto pixels = PictureRenderer(200, 200).render_rgba(list);
    return std::array{test::at(pixels, 200, 120, 120), test::at(pixels, 200, 80, 80)};
  };
  const auto up = halves({1, 1.5f}), down = halves({1.5f, 1}), plain = halves({});
  EXPECT_TRUE(violet(up[0]) && yellow(up[1]));
  EXPECT_TRUE(yellow(down[0]) && violet(down[1]));
  EXPECT_FALSE(violet(plain[0]) || yellow(plain[0]) || violet(plain[1]) || yellow(plain[1]));  // control
  EXPECT_EQ(test::code_of([&] { halves({1}); }), "invalid_draw_list");
}

TEST(ElementColours, EveryTriangleHasTheColourOfItsElement) {
  // Viridis begins violet and ends yellow.
  for (const char* element : {"quad4", "tri3"}) {
    test::PictureSession s(squares(R"("color_by": "jacobian")", element), 1);
    const auto [low, high] = middles(s.list());
    EXPECT_TRUE(violet(low)) << element << ' ' << low.r << ' ' << low.g << ' ' << low.b;
    EXPECT_TRUE(yellow(high)) << element << ' ' << high.r << ' ' << high.g << ' ' << high.b;
    // Control: without the field both are alike.
    PictureLook plain;
    plain.color_by = "";
    const auto [a, b] = middles(s.list(plain));
    EXPECT_FALSE(violet(a) || yellow(b));
    EXPECT_LT(std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b), 12);  // light alone
  }
}

TEST(ElementColours, ABarExplainsThem) {
  test::PictureSession s(squares(R"("color_by": "jacobian")"), 1);
  const DrawList list = s.list();
  ASSERT_EQ(list.points.size(), 1u);
  // Two triangles for each quadrangle; displacements are prescribed, so that only rounding is left.
  const std::vector<float>& values = list.points[0].triangle_scalar;
  ASSERT_EQ(values.size(), 4u);
  for (size_t k = 0; k < 4; ++k) EXPECT_NEAR(values[k], k < 2 ? 1 : 1.5, 1e-6) << k;
  EXPECT_EQ(list.points[0].scalar_label, "jacobian");
  EXPECT_FALSE(list.points[0].scalar_max);
  // Controls: a given range and legend hold; the points' own field comes before that of the elements.
  test::PictureSession given(squares(R"("color_by": "jacobian", "range": [0, 3], "legend": "volume")"), 1);
  EXPECT_EQ(given.list().points[0].scalar_max, 3.0f);
  EXPECT_EQ(given.list().points[0].scalar_label, "volume");
  test::PictureSession nodal(squares(R"("color_by": "von_mises")"), 1);
  EXPECT_TRUE(nodal.list().points[0].triangle_scalar.empty());
  EXPECT_EQ(nodal.list().points[0].scalar.size(), 8u);
}

TEST(ElementColours, TheSurfaceOfASolidShowsTheElementsBelowIt) {
  test::PictureSession s(
      R"({"time": {"dt": 0.01}, "viewer": {"color_by": "energy_density"}, "systems": [{"type": "fem",
    "id": "s", "block": {"size": [2, 1, 1], "cells_x": 2, "cells_y": 1, "cells_z": 1}, "element": "hex8"}]})",
      0);
  const auto frame = s.session().frame(picture_request(s.session().world()));
  const PartDrawing& drawing = frame->constant->parts[0];
  ASSERT_EQ(drawing.triangles.size(), 20u);  // ten outer faces
  ASSERT_EQ(drawing.triangle_elements.size(), 20u);
  const std::vector<float> x = FrameValues(*frame, 0, 0).floats();
  for (size_t t = 0; t < 20; ++t) {
    float middle = 0, start = 0;
    for (const uint32_t p : drawing.triangles[t]) middle += x[3 * p] / 3;
    for (size_t p = 0; p < x.size(); p += 3) start = std::min(start, x[p]);
    EXPECT_EQ(drawing.triangle_elements[t], middle - start > 1 ? 1u : 0u) << t;
  }
}

TEST(ElementColours, AFieldOfThePointsComesBeforeThatOfTheirSprings) {
  const auto drawn = [](const std::string& shape, const std::string& viewer) {
    return test::PictureSession(R"({"time": {"dt": 0.001}, "viewer": {)" + viewer +
                                    R"(}, "systems": [{"type": "mass_spring", "id": "c", )" + shape + "}]}",
                                0)
        .list()
        .points[0];
  };
  const std::string cloth = R"("cloth_grid": {"nx": 4, "ny": 4})",
                    rope = R"("rope": {"from": [0, 0, 0], "to": [1, 0, 0]})";
  // Springs below a surface are not drawn; those of a rope have a value each.
  const DrawPoints surface = drawn(cloth, R"("color_by": "strain")"), plain = drawn(cloth, "");
  EXPECT_FALSE(surface.triangles.empty());
  EXPECT_EQ(3 * surface.scalar.size(), surface.positions.size());
  EXPECT_TRUE(surface.lines.empty());
  EXPECT_TRUE(plain.scalar.empty());
  const DrawPoints lines = drawn(rope, R"("color_by": "strain")");
  EXPECT_EQ(2 * lines.line_scalar.size(), lines.lines.size());
  EXPECT_EQ(lines.line_scalar.size(), 20u);
  EXPECT_TRUE(drawn(rope, "").line_scalar.empty());  // control
}

/// Two balls that hang at the world's joints, the second three times as heavy.
std::string hanging(const std::string& viewer) {
  return R"({"time": {"dt": 0.01}, "gravity": [0, -10, 0], "viewer": {)" + viewer +
         R"(}, "systems": [{"type": "rigid3d", "id": "r", "sleeping": false, "bodies": [
      {"type": "sphere", "radius": 0.2, "mass": 1, "position": [0, 0, 0]},
      {"type": "sphere", "radius": 0.2, "mass": 3, "position": [2, 0, 0]}],
    "joints": [{"type": "ball", "a": -1, "b": 0, "anchor": [0, 1, 0]},
               {"type": "ball", "a": -1, "b": 1, "anchor": [2, 1, 0]}]}]})";
}

bool same(const Color& a, const Color& b) {
  return a.r == b.r && a.g == b.g && a.b == b.b;
}

TEST(ElementColours, MarksOfJointsHaveTheColoursOfTheirForces) {
  test::PictureSession s(hanging(R"("color_by": "force")"), 20);
  const DrawList list = s.list();
  const auto count = [](const DrawList& l, float t) {
    return std::count_if(l.marks.begin(), l.marks.end(), [&](const DrawMark& m) {
      return same(m.color, picture::map_color(ColorMap::viridis, t, picture::Paper::bright));
    });
  };
  EXPECT_EQ(count(list, 0), 3);  // a line and two ends
  EXPECT_EQ(count(list, 1), 3);
  ASSERT_TRUE(list.scale);
  EXPECT_EQ(list.scale->label, "force (N)");
  // They hang at rest: m g.
  EXPECT_NEAR(list.scale->low, 10, 0.1);
  EXPECT_NEAR(list.scale->high, 30, 0.3);
  // Controls: no field, no marks; on request they have the colours of their kinds.
  PictureLook plain;
  plain.color_by = "";
  EXPECT_TRUE(s.list(plain).marks.empty());
  plain.marks = Wish::joints;
  EXPECT_EQ(s.list(plain).marks.size(), 6u);
  EXPECT_EQ(count(s.list(plain), 0) + count(s.list(plain), 1), 0);
  EXPECT_FALSE(s.list(plain).scale);
}

TEST(ElementColours, JointsAreFoundBehindOtherSystems) {
  std::string scene = hanging(R"("color_by": "force")");
  scene.insert(scene.find("{\"type\": \"rigid3d\""),
               R"({"type": "fem", "id": "f", "block": {"size": [1, 1, 1],
    "cells_x": 1, "cells_y": 1, "cells_z": 1}}, )");
  const DrawList list = test::PictureSession(scene, 20).list();
  ASSERT_TRUE(list.scale);
  EXPECT_NEAR(list.scale->high, 30, 0.3);
}

TEST(ElementColours, WhatNothingShowsIsRefusedWithWhatCanBeShown) {
  const auto issue = [](const World& world, const std::string& name) {
    try {
      require_color(world, name);
    } catch (const Error& e) {
      return e.issues().at(0);
    }
    return Issue{};
  };
  const World fem(parse_scene(squares("")));
  EXPECT_EQ(issue(fem, "energy_density").pointer, "");  // control
  EXPECT_NE(issue(fem, "energy").allowed.find("energy_density"), std::string::npos);
  EXPECT_EQ(issue(*testing::world_of_part(testing::values_part, ""), "load").pointer, "?color_by");
  // A scene is told at once: angles of a pendulum belong to joints that have no marks.
  const auto refused = [](const std::string& by) {
    try {
      const World world(parse_scene(R"({"time": {"dt": 0.001}, "viewer": {"color_by": ")" + by +
                                    R"("}, "systems": [{"type": "pendulum", "id": "p"}]})"));
    } catch (const Error& e) {
      return e.issues().at(0);
    }
    return Issue{};
  };
  EXPECT_EQ(refused("angle").pointer, "/viewer/color_by");
  EXPECT_EQ(refused("angle").allowed, "position, velocity, speed");
  EXPECT_EQ(refused("speed").pointer, "");  // control
}

}  // namespace
}  // namespace truestep
