// BVH files: every order of channels, errors with their place, and round trips through writing.
#include "engine/geometry/read/bvh.h"

#include <gtest/gtest.h>

#include <random>

#include "engine/kernels/animation/rotations.h"

namespace truestep {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out(1);
  for (const char c : text) {
    if (c == '\n') {
      out.emplace_back();
    } else {
      out.back() += c;
    }
  }
  return out;
}

std::string file(const std::string& channels = "Zrotation Xrotation Yrotation") {
  return "HIERARCHY\nROOT Hips\n{\n  OFFSET 0 0 0\n  CHANNELS 6 Xposition Yposition Zposition " + channels +
         "\n  JOINT Spine\n  {\n    OFFSET 0 10 0\n    CHANNELS 3 " + channels +
         "\n    End Site\n    {\n      OFFSET 0 5 1\n    }\n  }\n}\nMOTION\nFrames: 2\nFrame Time: 0.025\n"
         "1 2 3 10 20 30 40 50 60\n4 5 6 0 0 0 -1e1 +5 .5\n";
}

size_t fault(const std::string& text) {
  try {
    read_bvh(lines_of(text));
  } catch (const BvhFault& f) {
    EXPECT_NE(std::string(f.what()).find("line " + std::to_string(f.line)), std::string::npos);
    return f.line;
  }
  return 0;
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = file();
  text.replace(text.find(from), from.size(), to);
  return text;
}

TEST(Bvh, ReadsEveryOrderOfChannels) {
  using animation::turn_about;
  const char axes[] = "XYZ";
  int order[] = {0, 1, 2};
  do {
    std::string channels;
    for (const int a : order) channels += std::string(1, axes[a]) + "rotation ";
    const BvhMotion m = read_bvh(lines_of(file(channels)));
    ASSERT_EQ(m.joints.size(), 2u);
    EXPECT_EQ(m.joints[1].name, "Spine");
    EXPECT_EQ(m.joints[1].parent, 0);
    EXPECT_EQ(*m.joints[1].end, (Vec3{0, 5, 1}));
    EXPECT_EQ(m.frames, 2u);
    EXPECT_EQ(m.frame_time, 0.025);
    Quat want;
    const double degrees[] = {40, 50, 60};
    for (int k = 0; k < 3; ++k) {
      const Vec3 axis{order[k] == 0 ? 1.0 : 0.0, order[k] == 1 ? 1.0 : 0.0, order[k] == 2 ? 1.0 : 0.0};
      want = want * turn_about(axis, degrees[k] * 0.017453292519943295);
    }
    const Pose p = m.local(0, 1);
    EXPECT_EQ(p.position, (Vec3{0, 10, 0}));
    EXPECT_NEAR(p.orientation.w * want.w + p.orientation.x * want.x + p.orientation.y * want.y +
                    p.orientation.z * want.z,
                1, 1e-15);
    EXPECT_EQ(m.local(1, 0).position, (Vec3{4, 5, 6}));
  } while (std::next_permutation(order, order + 3));
}

TEST(Bvh, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(fault(file()), 0u);
  EXPECT_EQ(fault(""), 2u) << "after the last line";
  EXPECT_EQ(fault(with("HIERARCHY", "HIRARCHY")), 1u);
  EXPECT_EQ(fault(with("OFFSET 0 10 0", "OFFSET 0 10")), 9u) << "CHANNELS is no number";
  EXPECT_EQ(fault(with("OFFSET 0 10 0", "OFFSET 0 nan 0")), 8u);
  EXPECT_EQ(fault(with("OFFSET 0 10 0", "OFFSET 0 1e300 0")), 8u);
  EXPECT_EQ(fault(with("OFFSET 0 10 0", "OFFSET 0 10 0 OFFSET 0 10 0")), 8u);
  EXPECT_EQ(fault(with("CHANNELS 3", "CHANNELS 4")), 10u) << "End is no channel";
  EXPECT_EQ(fault(with("CHANNELS 3 Z", "CHANNELS 3 W")), 9u);
  EXPECT_EQ(fault(with("CHANNELS 3 Z", "CHANNELS 3 X")), 9u) << "twice";
  EXPECT_EQ(fault(with("Frames: 2", "Frames: 3")), 22u) << "the file ends";
  EXPECT_EQ(fault(with("Frames: 2", "Frames: 1")), 20u) << "there is more";
  EXPECT_EQ(fault(with("Frames: 2", "Frames: -1")), 17u);
  EXPECT_EQ(fault(with("Frames: 2", "Frames: 1e9")), 17u);
  EXPECT_EQ(fault(with("0.025", "0")), 18u);
  EXPECT_EQ(fault(with("    }\n  }\n}\n", "    }\n  }\n")), 15u) << "a brace is missing";
  std::string deep = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n";
  for (int k = 0; k < 5000; ++k) deep += "JOINT a { OFFSET 0 0 0\n";
  EXPECT_GT(fault(deep), 1000u);
}

TEST(Bvh, ComesBackFromWriting) {
  const BvhMotion m = read_bvh(lines_of(file())), again = read_bvh(lines_of(write_bvh(m)));
  EXPECT_EQ(m.values, again.values);
  EXPECT_EQ(m.frame_time, again.frame_time);
  EXPECT_EQ(m.joints[1].channels, again.joints[1].channels);
  EXPECT_EQ(m.joints[1].end, again.joints[1].end);
  EXPECT_EQ(write_bvh(m), write_bvh(again));
}

TEST(Bvh, AnythingIsReadOrRefused) {
  std::mt19937 engine(31);
  const std::string good = file();
  int refused = 0;
  for (int k = 0; k < 20000; ++k) {
    std::string text = good;
    for (int changes = 1 + static_cast<int>(engine() % 4); changes > 0; --changes) {
      const size_t at = engine() % text.size(), length = engine() % 12;
      if (engine() % 3 == 0) {
        text.erase(at, length);
      } else if (engine() % 2) {
        text.insert(at, good.substr(engine() % good.size(), length));
      } else {
        text[at] = static_cast<char>(engine() % 256);
      }
      if (text.empty()) text = "x";
    }
    const size_t line = fault(text);
    refused += line > 0;
    EXPECT_LE(line, lines_of(text).size() + 1);
  }
  EXPECT_GT(refused, 10000);
}

}  // namespace
}  // namespace truestep
