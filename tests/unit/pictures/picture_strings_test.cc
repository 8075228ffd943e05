// Strings in pictures: distance joints, springs and attachments are lines between the objects that they hold,
// copies included, until they break; they are visible in both themes.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/sinks/picture/picture.h"
#include "tests/unit/pictures/picture_session.h"

namespace truestep {
namespace {

std::string scene(const std::string& systems, const std::string& couplings = "[]") {
  return R"({"schema_version": "1.0", "name": "s", "time": {"dt": 0.01}, "viewer": {"camera": {"eye": [0, 0, 9],
    "target": [0, 0, 0]}}, "systems": )" +
         systems + R"(, "couplings": )" + couplings + "}";
}

/// The end points of the lines in the last set of points, if that has nothing but lines; empty without
/// strings.
std::vector<float> strings(const DrawList& list) {
  for (const DrawPoints& p : list.points) {
    if (p.radius == 0 && p.point_pixels == 0 && !p.lines.empty()) return p.positions;
  }
  return {};
}

constexpr const char* kPendulum = R"([{"type": "rigid2d", "id": "p", "bodies": [{"shapes": [{"type": "circle",
  "radius": 0.2}], "position": [1, 0, 0]}], "joints": [{"type": "distance", "a": -1, "b": 0, "anchor": [0, 1, 0],
  "anchor_b": [1, 0, 0]}]}])";

TEST(PictureStrings, APendulumHangsOnALine) {
  const test::PictureSession s(scene(kPendulum), 0);
  EXPECT_EQ(strings(s.list()), (std::vector<float>{0, 1, 0, 1, 0, 0}));
}

TEST(PictureStrings, TheLineFollowsTheBody) {
  test::PictureSession s(scene(kPendulum), 20);
  const std::vector<float> ends = strings(s.list());
  ASSERT_EQ(ends.size(), 6u);
  EXPECT_NEAR(ends[4], -0.5 * 0.5 * 9.81 * 0.04, 0.01);  // half of gravity along the circle, for 0.2 s
  EXPECT_NEAR(std::hypot(ends[3], ends[4] - 1), std::sqrt(2.0),
              1e-3);  // its length, within the solver's slack
}

TEST(PictureStrings, CopiesHaveThemToo) {
  const test::PictureSession s(
      scene(
          R"([{"type": "rigid3d", "id": "c", "bodies": [{"type": "sphere", "radius": 0.2, "position": [0, 0, 0],
        "copies": {"layout": "grid", "count": [3, 1, 1], "spacing": [0.5, 1, 1]}}], "joints": [{"type": "distance", "a": -1, "b": 0,
        "anchor": [0, 1, 0], "anchor_b": [0, 0, 0], "repeat": 3, "step": 1, "offset": [0.5, 0, 0]}]}])"),
      0);
  EXPECT_EQ(strings(s.list()).size(), 3u * 6);
}

TEST(PictureStrings, WhatIsAttachedHangsOnALine) {
  const std::string two = R"([{"type": "particles", "id": "a", "positions": [[0, 1, 0]]},
    {"type": "particles", "id": "b", "positions": [[0.5, 0, 0]]}])";
  const test::PictureSession s(
      scene(
          two,
          R"([{"type": "attachment", "a": "a", "b": "b", "a_points": [0], "b_points": [0], "link": "rigid"}])"),
      0);
  EXPECT_EQ(strings(s.list()), (std::vector<float>{0, 1, 0, 0.5f, 0, 0}));
  EXPECT_TRUE(strings(test::PictureSession(scene(two), 0).list()).empty());  // control
}

TEST(PictureStrings, ABrokenJointHasNone) {
  std::string breaking = kPendulum;
  breaking.insert(breaking.find("\"a\": -1"), R"("break_force": 1e-6, )");
  test::PictureSession s(scene(breaking), 0);
  EXPECT_EQ(strings(s.list()).size(), 6u);
  s.session().step(10);
  EXPECT_TRUE(strings(s.list()).empty());
}

TEST(PictureStrings, TheyAreSeenInBothThemes) {
  const test::PictureSession s(scene(kPendulum), 0);
  PictureRenderer renderer(160, 120);
  using Theme = PictureLook::Theme;
  for (const Theme theme : {Theme::light, Theme::dark}) {
    DrawList with = s.list({.theme = theme}), without = with;
    std::erase_if(without.points, [](const DrawPoints& p) { return !p.lines.empty(); });
    const auto a = renderer.render_rgba(with), b = renderer.render_rgba(without);
    int changed = 0;
    for (size_t i = 0; i < a.size(); i += 4) {
      const int d = a[i] + a[i + 1] + a[i + 2] - b[i] - b[i + 1] - b[i + 2];
      changed += theme == Theme::light ? d < -150 : d > 150;  // dark on light, light on dark
    }
    EXPECT_GT(changed, 15);
  }
}

}  // namespace
}  // namespace truestep
