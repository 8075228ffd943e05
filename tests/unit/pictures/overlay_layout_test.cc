// Caption, legend and colour bar of a picture never lie on each other, whatever their words and the picture's
// size; names of things give way to them and to each other.
#include "engine/sinks/picture/text/overlay_layout.h"

#include <gtest/gtest.h>

#include <random>

#include "engine/sinks/picture/camera.h"
#include "engine/sinks/picture/text/font.h"

namespace truestep {
namespace {

using picture::layout_overlay;
using picture::OverlayLayout;
using picture::Rectangle;

DrawList words(size_t title, size_t rows, size_t label) {
  DrawList list;
  list.caption = std::string(title, 'n') + "   t = 12.345 s";
  for (size_t k = 0; k < rows; ++k) list.legend.push_back({"system " + std::to_string(k), {}});
  if (label > 0) list.scale = DrawScale{std::string(label, 'm'), ColorMap::viridis, -1234.5f, 1};
  return list;
}

void expect_apart(const OverlayLayout& layout, int width, int height) {
  for (size_t i = 0; i < layout.panels.size(); ++i) {
    const Rectangle& r = layout.panels[i];
    EXPECT_GE(r.left, 0);
    EXPECT_GE(r.top, 0);
    EXPECT_LE(r.right, width);
    EXPECT_LE(r.bottom, height);
    for (size_t j = 0; j < i; ++j) EXPECT_FALSE(r.meets(layout.panels[j])) << i << " and " << j;
  }
}

TEST(OverlayLayout, WordsAreApartForAnyLengthAndSize) {
  std::mt19937 random(5);
  const auto upto = [&](size_t n) { return random() % (n + 1); };
  for (int k = 0; k < 400; ++k) {
    const int width = 320 + static_cast<int>(upto(1600)), height = 200 + static_cast<int>(upto(900));
    const DrawList list = words(upto(120), upto(20), upto(24));
    const OverlayLayout layout = layout_overlay(list, nullptr, width, height);
    SCOPED_TRACE(::testing::Message() << width << " x " << height << ": " << list.caption);
    expect_apart(layout, width, height);
    EXPECT_FALSE(layout.caption.empty());
  }
}

TEST(OverlayLayout, AShortTitleIsInOneLineAndALongOneAboveItsTime) {
  EXPECT_EQ(layout_overlay(words(10, 0, 8), nullptr, 640, 360).caption.size(), 1u);
  const OverlayLayout layout = layout_overlay(words(70, 0, 8), nullptr, 640, 360);
  ASSERT_EQ(layout.caption.size(), 2u);
  EXPECT_EQ(layout.caption[1].text, "t = 12.345 s");
  ASSERT_TRUE(layout.bar);
  // Control: in one line it would lie on the bar.
  const double one = picture::text_width(words(70, 0, 8).caption, 7);
  EXPECT_GT(layout.caption[0].x + one, layout.bar->bar.left);
}

TEST(OverlayLayout, ManyRowsMakeColumns) {
  const OverlayLayout layout = layout_overlay(words(10, 32, 8), nullptr, 1280, 360);
  ASSERT_EQ(layout.legend.size(), 32u);
  EXPECT_GT(layout.legend.back().swatch.left, layout.legend.front().swatch.left);
  expect_apart(layout, 1280, 360);
}

TEST(OverlayLayout, NamesBesideThingsGiveWay) {
  DrawList list = words(10, 3, 8);
  list.camera = DrawCamera{{0, 0, 10}, {}, {}, 35};
  // Five at one place: four sides have room, and nothing is written over anything.
  for (int k = 0; k < 5; ++k)
    list.labels.push_back({"name " + std::to_string(k), {}, DrawLabel::Side::beside, {}});
  const picture::View view(list, 640, 360);
  const OverlayLayout layout = layout_overlay(list, &view, 640, 360);
  EXPECT_EQ(layout.labels.size(), 4u);
  for (size_t i = 0; i < layout.labels.size(); ++i)
    for (size_t j = 0; j < i; ++j) EXPECT_FALSE(layout.labels[i].bounds().meets(layout.labels[j].bounds()));
}

TEST(Font, LettersCoverTheirArea) {
  // A full stop is a square: its coverage is its area, wherever it lies between the pixels.
  const auto ink = [](std::string_view text, double x) {
    double sum = 0;
    for (const float c : picture::text_coverage(text, {x, 30, 20}, 120, 40)) sum += c;
    return sum;
  };
  EXPECT_NEAR(ink(".", 10), ink(".", 10.37), 1e-3);
  EXPECT_GT(ink("M", 10), 3 * ink(".", 10));
  EXPECT_EQ(ink(" ", 10), 0);
  // Two letters have the ink of both; an O has a hole.
  EXPECT_NEAR(ink("Ol", 10), ink("O", 10) + ink("l", 10), 1e-3);
  EXPECT_LT(ink("O", 10), 0.7 * 20 * picture::text_width("O", 20));
}

TEST(Font, KnowsAccentsAndGreekAndQuestionsWhatItLacks) {
  EXPECT_GT(picture::text_width("ω", 10), 0);
  EXPECT_NEAR(picture::text_width("Kármán", 10), picture::text_width("Karman", 10), 0.5);
  EXPECT_EQ(picture::text_width("\u4e00", 10), picture::text_width("?", 10));
  EXPECT_EQ(picture::text_width("\xff", 10), picture::text_width("?", 10));
}

}  // namespace
}  // namespace truestep
