// A colour bar says what its colours show: what the scene calls it, or the field's name.
#include <gtest/gtest.h>

#include "tests/unit/pictures/picture_session.h"

namespace truestep {
namespace {

std::string flow_scene(const std::string& viewer) {
  return R"({"schema_version": "1.0", "name": "t", "time": {"dt": 0.01}, "systems": [{"type": "grid_fluid", "id": "box",
             "cells": [8, 8], "size": [1, 1], "scalar": {"initial": "x"}}], "viewer": )" +
         viewer + "}";
}

std::string label(const std::string& viewer, const PictureLook& look = {}) {
  const DrawList list = test::PictureSession(flow_scene(viewer), 0).list(look);
  for (const DrawPoints& points : list.points) {
    if (!points.scalar_label.empty()) return points.scalar_label;
  }
  return "";
}

TEST(PictureLegend, TheSceneSaysWhatItsColoursShow) {
  EXPECT_EQ(label(R"({"color_by": "scalar", "legend": "smoke"})"), "smoke");
  EXPECT_EQ(label(R"({"color_by": "pressure", "legend": "overpressure"})"), "overpressure (Pa)");
}

TEST(PictureLegend, WithoutWordsItIsTheField) {
  EXPECT_EQ(label(R"({"color_by": "scalar"})"), "scalar");
}

// A grid that has no such field shows its first one: that is not what the scene has words for.
TEST(PictureLegend, ItIsNotThatOfTheFieldShownInstead) {
  PictureLook look;
  look.color_by = "depth";
  EXPECT_EQ(label(R"({"color_by": "scalar", "legend": "smoke"})", look), label("{}"));
}

TEST(PictureLegend, ItNeedsAFieldToSpeakOf) {
  EXPECT_THROW(label(R"({"legend": "smoke"})"), Error);
}

TEST(PictureLegend, ItIsNotThatOfAnotherFieldThatIsAskedFor) {
  PictureLook look;
  look.color_by = "pressure";
  EXPECT_EQ(label(R"({"color_by": "scalar", "legend": "smoke"})", look), "pressure (Pa)");
}

}  // namespace
}  // namespace truestep
