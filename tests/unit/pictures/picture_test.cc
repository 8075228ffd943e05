// Pictures: size, colour, light, shadow, determinism and limits, all read back from pixels.
#include "engine/sinks/picture/picture.h"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

#include "engine/sinks/picture/camera.h"
#include "tests/unit/pictures/picture_lists.h"
#include "tests/unit/pictures/picture_pixels.h"

namespace truestep {
namespace {

using test::at;
using test::brightness;
using test::code_of;
using test::one_sphere;
using test::Pixels;
using test::Rgb;

TEST(Picture, PngDecodesToTheSamePixels) {
  PictureRenderer renderer(120, 80);
  const Pixels rgba = renderer.render_rgba(one_sphere({0.8f, 0.1f, 0.1f}));
  const std::vector<uint8_t> file = encode_png(rgba, 120, 80);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_memory(&image, file.data(), file.size()));
  EXPECT_EQ(image.width, 120u);
  EXPECT_EQ(image.height, 80u);
  image.format = PNG_FORMAT_RGBA;
  Pixels decoded(PNG_IMAGE_SIZE(image));
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, decoded.data(), 0, nullptr));
  EXPECT_EQ(decoded, rgba);
}

TEST(Picture, PngRefusesAWrongNumberOfBytes) {
  EXPECT_EQ(code_of([] { encode_png(Pixels(4 * 6), 2, 2); }), "invalid_picture");
  EXPECT_EQ(code_of([] { encode_png({}, 0, 5); }), "invalid_picture");
}

TEST(Picture, ARedSphereIsRedInTheMiddleAndNowhereElse) {
  PictureRenderer renderer(200, 150);
  const Pixels red = renderer.render_rgba(one_sphere({0.9f, 0.05f, 0.05f}));
  const Rgb centre = at(red, 200, 100, 75);
  EXPECT_GT(centre.r, 120);
  EXPECT_LT(centre.g, centre.r / 2);
  EXPECT_LT(centre.b, centre.r / 2);
  // Control: without the sphere every pixel is background, and the corners do not change.
  const Pixels empty = renderer.render_rgba({});
  EXPECT_GT(at(empty, 200, 100, 75).g, 150);
  for (int x : {0, 199})
    for (int y : {0, 149}) {
      const Rgb a = at(red, 200, x, y), b = at(empty, 200, x, y);
      EXPECT_EQ(brightness(a), brightness(b)) << x << " " << y;
    }
  // The first row is the top one: the key light comes from above, so the upper half of the sphere is
  // brighter.
  EXPECT_GT(at(red, 200, 100, 55).r, at(red, 200, 100, 95).r + 20);
  // Radius 0.5 at distance 4 covers 75 pixels times 0.5 / (4 tan 15 deg), seen at sqrt(1 - (r/d)^2).
  int covered = 0;
  for (int x = 0; x < 200; ++x) covered += at(red, 200, x, 75).g < 150;
  const double half = 75 * 0.5 / (4 * std::tan(15 * M_PI / 180)) / std::sqrt(1 - 0.125 * 0.125);
  EXPECT_NEAR(covered, 2 * half, 1.5);  // a pixel of rounding at either edge
}

TEST(Picture, AShadowDarkensTheGroundUnderASphereOnly) {
  PictureRenderer renderer(200, 200);
  DrawList list = one_sphere({0.5f, 0.5f, 0.5f});
  list.points[0].positions = {0, 1, 0};
  list.ground_height = 0;
  list.camera = DrawCamera{{0, 8, 0.01}, {0, 0, 0}, {}, 40};
  const Pixels with = renderer.render_rgba(list);
  // The light falls towards (0.5, -1, -0.45), so the shadow's centre is at x = 0.5, z = -0.45: right of and
  // above the middle. One metre is 100 / (8 tan 20 deg) = 34 pixels; the sample is between grid lines.
  const int x = 100 + 20, y = 100 - 19;
  list.points.clear();
  const Pixels without = renderer.render_rgba(list);
  EXPECT_LT(brightness(at(with, 200, x, y)), brightness(at(without, 200, x, y)) - 90);
  // Control: the mirrored place is as bright as without the sphere.
  EXPECT_NEAR(brightness(at(with, 200, 200 - x, 200 - y)), brightness(at(without, 200, 200 - x, 200 - y)), 6);
}

TEST(Picture, SurfacesAreLitFromBothSides) {
  PictureRenderer renderer(64, 64);
  DrawList list;
  DrawPoints sheet;
  sheet.positions = {-1, 0, -1, 1, 0, -1, 1, 0, 1, -1, 0, 1};
  sheet.triangles = {0, 1, 2, 0, 2, 3};
  sheet.color = Color{0.2f, 0.7f, 0.3f};
  list.points.push_back(sheet);
  for (double height : {3.0, -3.0}) {
    list.camera = DrawCamera{{0.2, height, 0.4}, {0, 0, 0}, {}, 30};
    const Pixels one = renderer.render_rgba(list);
    std::reverse(list.points[0].triangles.begin(), list.points[0].triangles.end());  // the other winding
    const Pixels other = renderer.render_rgba(list);
    const Rgb a = at(one, 64, 32, 32), b = at(other, 64, 32, 32);
    EXPECT_GT(a.g, a.r + 30);
    EXPECT_NEAR(a.g, b.g, 3);
  }
}

TEST(Picture, SameListSameBytes) {
  PictureRenderer renderer(160, 120), another(160, 120);
  const DrawList list = test::balls_in_box(60);
  const Pixels first = renderer.render_rgba(list);
  EXPECT_EQ(first, renderer.render_rgba(list));
  EXPECT_EQ(first, another.render_rgba(list));
  Pixels elsewhere;
  std::thread([&] { elsewhere = renderer.render_rgba(list); }).join();
  EXPECT_EQ(first, elsewhere);
  renderer.render_rgba(test::fountain(50));  // the picture in between leaves no trace
  EXPECT_EQ(first, renderer.render_rgba(list));
  EXPECT_NE(first, renderer.render_rgba(test::balls_in_box(61)));  // control
}

TEST(Picture, TwoThreadsWithTheirOwnRenderers) {
  const DrawList list = test::spring_net(10);
  Pixels results[2];
  {
    std::vector<std::thread> threads;
    for (Pixels& result : results)
      threads.emplace_back([&] {
        PictureRenderer renderer(96, 64);
        for (int i = 0; i < 3; ++i) result = renderer.render_rgba(list);
      });
    for (std::thread& t : threads) t.join();
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST(Picture, BadSizesAreRefused) {
  const std::pair<int, int> bad[] = {{15, 100}, {100, 4097}, {0, 0}, {-1, 64}, {1 << 30, 64}};
  for (const auto& [w, h] : bad)
    EXPECT_EQ(code_of([=] { PictureRenderer(w, h); }), "out_of_range") << w << " x " << h;
  PictureRenderer renderer(16, 16);
  EXPECT_EQ(code_of([&] { renderer.resize(5000, 16); }), "out_of_range");
  EXPECT_EQ(renderer.render_rgba({}).size(), 16u * 16 * 4);
  renderer.resize(40, 20);
  EXPECT_EQ(renderer.render_rgba({}).size(), 40u * 20 * 4);
}

TEST(Picture, BadListsAreRefused) {
  PictureRenderer renderer(32, 32);
  DrawList list = one_sphere({});
  const auto refused = [&](auto change) {
    DrawList bad = list;
    change(bad.points[0]);
    return code_of([&] { renderer.render_rgba(bad); });
  };
  EXPECT_EQ(refused([](DrawPoints&) {}), "");  // control
  EXPECT_EQ(refused([](DrawPoints& p) { p.lines = {0, 1}; }), "invalid_draw_list");
  EXPECT_EQ(refused([](DrawPoints& p) { p.lines = {0}; }), "invalid_draw_list");
  EXPECT_EQ(refused([](DrawPoints& p) { p.triangles = {0, 0, 7}; }), "invalid_draw_list");
  EXPECT_EQ(refused([](DrawPoints& p) { p.radii = {1, 2}; }), "invalid_draw_list");
  EXPECT_EQ(refused([](DrawPoints& p) { p.scalar = {1, 2}; }), "invalid_draw_list");
  EXPECT_EQ(refused([](DrawPoints& p) { p.positions.pop_back(); }), "invalid_draw_list");
}

TEST(Picture, NumbersThatAreNotFiniteAreLeftOut) {
  PictureRenderer renderer(64, 64);
  DrawList list = one_sphere({0.9f, 0.1f, 0.1f});
  const Pixels clean = renderer.render_rgba(list);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  list.points[0].positions.insert(list.points[0].positions.end(), {nan, 0, 0, 0, inf, 0, 1e30f, 0, 0});
  EXPECT_EQ(clean, renderer.render_rgba(list));
  list.camera.reset();
  list.points[0].positions.resize(9);
  EXPECT_GT(at(renderer.render_rgba(list), 64, 32, 32).r, 100);  // framing ignores them too
}

TEST(Picture, ScaleDoesNotMatter) {
  PictureRenderer renderer(64, 64);
  const Pixels metre = renderer.render_rgba(one_sphere({0.9f, 0.1f, 0.1f}));
  for (double scale : {1e-9, 1e11}) {
    DrawList list = one_sphere({0.9f, 0.1f, 0.1f});
    list.points[0].radius *= static_cast<float>(scale);
    list.camera->eye = list.camera->eye * scale;
    const Pixels scaled = renderer.render_rgba(list);
    int worst = 0;
    for (size_t i = 0; i < scaled.size(); ++i) worst = std::max(worst, std::abs(scaled[i] - metre[i]));
    EXPECT_LE(worst, 64) << scale;  // one of four samples of an edge pixel may flip
    EXPECT_EQ(at(scaled, 64, 32, 32).r, at(metre, 64, 32, 32).r);
  }
}

// Number of pixels that are more red than the background.
int red_pixels(const Pixels& rgba) {
  int n = 0;
  for (size_t i = 0; i < rgba.size(); i += 4) n += rgba[i] > rgba[i + 1] + 60;
  return n;
}

TEST(Picture, SmallSpheresAreAsLargeAsBigOnes) {
  // Spheres under 5 pixels of radius are drawn as flat-depth sprites, larger ones are ray-cast.
  PictureRenderer renderer(600, 600);
  DrawList list = one_sphere({0.9f, 0.1f, 0.1f});
  const double pixel = 2 * 4 * std::tan(15 * M_PI / 180) / 600;  // m at the sphere
  for (double radius : {3.0, 4.8, 5.2, 20.0}) {
    list.points[0].radius = static_cast<float>(radius * pixel);
    // Half-covered edge pixels count or not: within a third of a pixel of the circle's edge.
    EXPECT_NEAR(red_pixels(renderer.render_rgba(list)), M_PI * radius * radius, 2 * M_PI * radius / 3)
        << radius;
  }
}

TEST(Picture, NearSpritesHideFarOnesInAnyOrder) {
  PictureRenderer renderer(200, 200);
  DrawList list = one_sphere({0.9f, 0.1f, 0.1f});
  list.points[0].positions = {0, 0, 0.1f, 0, 0, -0.1f};
  list.points[0].radius = 0.03f;
  list.points[0].scalar = {1, 0};
  const Rgb near_first = at(renderer.render_rgba(list), 200, 100, 100);
  list.points[0].positions = {0, 0, -0.1f, 0, 0, 0.1f};
  list.points[0].scalar = {0, 1};
  const Rgb near_last = at(renderer.render_rgba(list), 200, 100, 100);
  EXPECT_EQ(brightness(near_first), brightness(near_last));
  EXPECT_GT(near_first.g, 150);  // the yellow end of the map, not the violet one behind
}

TEST(Picture, TilesOfALargePictureFitTogether) {
  PictureRenderer renderer(4096, 64);  // two tiles; their seam runs through the sphere
  DrawList list = one_sphere({0.9f, 0.1f, 0.1f});
  list.camera->fov_degrees = 16;  // 57 pixels of diameter
  const Pixels rgba = renderer.render_rgba(list);
  for (int k : {0, 5, 20, 27, 29, 31}) {
    const auto height = [&](int x) {
      int n = 0;
      for (int y = 0; y < 64; ++y) n += at(rgba, 4096, x, y).g < 150;
      return n;
    };
    EXPECT_NEAR(height(2047 - k), height(2048 + k), 1) << k;
    EXPECT_GT(height(2048 + k), k < 10 ? 45 : -1);
  }
}

TEST(Picture, CaptionAndColourBarStayInTheirCorners) {
  PictureRenderer renderer(400, 300);
  const Pixels bare = renderer.render_rgba({});
  const auto changed = [&](const DrawList& list, int x0, int x1, int y0, int y1) {
    const Pixels rgba = renderer.render_rgba(list);
    int n = 0;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) n += brightness(at(rgba, 400, x, y)) != brightness(at(bare, 400, x, y));
    return n;
  };
  DrawList list;
  list.caption = "t = 1.25 s \xc3\xa9\n";  // a character missing in the font must not cause a failure
  EXPECT_GT(changed(list, 0, 200, 270, 300), 60);
  EXPECT_EQ(changed(list, 0, 400, 0, 260), 0);
  list.caption.clear();
  list.points.emplace_back();
  list.points[0].positions = {0, 0, 0};
  list.points[0].scalar = {2};
  EXPECT_EQ(changed(list, 0, 400, 0, 300), 0);  // control: no label, no bar
  list.points[0].scalar_label = "speed m/s";
  EXPECT_GT(changed(list, 250, 400, 240, 300), 400);
  EXPECT_EQ(changed(list, 0, 250, 0, 300), 0);
}

TEST(Picture, RoundingAtTheEndOfAColourBarIsZero) {
  PictureRenderer renderer(400, 300);
  const auto ends = [&](float low) {
    DrawList list;
    list.points.emplace_back();
    list.points[0].positions = {0, 0, 0}, list.points[0].scalar = {1};
    list.points[0].scalar_min = low, list.points[0].scalar_max = 1, list.points[0].scalar_label = "share";
    return renderer.render_rgba(list);
  };
  EXPECT_EQ(ends(-7e-14f), ends(0));
  EXPECT_NE(ends(-7e-3f), ends(0)) << "control";
}

TEST(Picture, EndsOfAColourBarHaveTheDigitsOfTheLarger) {
  PictureRenderer renderer(400, 300);
  const auto ends = [&](float low, float high) {
    DrawList list;
    list.points.emplace_back();
    list.points[0].positions = {0, 0, 0}, list.points[0].scalar = {high};
    list.points[0].scalar_min = low, list.points[0].scalar_max = high,
    list.points[0].scalar_label = "density";
    return renderer.render_rgba(list);
  };
  // 3010 and 0, not 3.01e+03 and 0.00117.
  EXPECT_EQ(ends(0, 3012), ends(0, 3010));
  EXPECT_EQ(ends(0.00117f, 2.06f), ends(0, 2.06f));
  EXPECT_NE(ends(0, 3012), ends(0, 3020)) << "control";
  EXPECT_NE(ends(0.0117f, 2.06f), ends(0, 2.06f)) << "control";
}

TEST(Picture, DemosAreWrittenForPeopleToLookAt) {
  const std::filesystem::path folder = std::filesystem::path(TRUESTEP_BINARY).parent_path() / "pictures";
  std::filesystem::create_directories(folder);
  PictureRenderer renderer(800, 600);
  const std::pair<const char*, DrawList> demos[] = {{"cloth", test::draped_cloth(60)},
                                                    {"fountain", test::fountain(5000)},
                                                    {"spring_net", test::spring_net(20)},
                                                    {"balls", test::balls_in_box(150)}};
  for (const auto& [name, list] : demos) {
    const Pixels rgba = renderer.render_rgba(list);
    const std::vector<uint8_t> file = encode_png(rgba, 800, 600);
    std::ofstream(folder / (std::string(name) + ".png"), std::ios::binary)
        .write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
    DrawList bare = list;
    bare.points.clear();
    bare.camera = picture::camera_for(list, 800.0 / 600);
    const Pixels empty = renderer.render_rgba(bare);
    size_t changed = 0;
    for (size_t i = 0; i < rgba.size(); i += 4) changed += std::abs(rgba[i] - empty[i]) > 12;
    EXPECT_GT(changed, rgba.size() / 4 / 20)
        << name << ": the points fill less than a twentieth of the picture";
  }
}

}  // namespace
}  // namespace truestep
