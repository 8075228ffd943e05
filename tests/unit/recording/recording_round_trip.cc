#include <cmath>
#include <limits>

#include "tests/unit/recording/recording_test.h"

namespace truestep::fixture {
namespace {

// 100 points share chunks of frames, 20000 have one chunk a frame, 150000 several chunks a frame.
class RecordingSizes : public RecordingTest, public ::testing::WithParamInterface<uint32_t> {};
INSTANTIATE_TEST_SUITE_P(Points, RecordingSizes, ::testing::Values(3, 100, 20000, 150000));

TEST_P(RecordingSizes, EveryNumberComesBack) {
  const uint64_t frames = GetParam() > 1000 ? 7 : 131;  // not a multiple of a chunk's frames
  const std::string file = record("a.vtkhdf", GetParam(), frames);
  EXPECT_EQ(good_frames(file), frames);
}

TEST_P(RecordingSizes, AWrongNumberIsNoticed) {  // control of is_frame
  RecordingReader reader(thread, record("a.vtkhdf", GetParam(), 3));
  RecordedFrame got;
  reader.read(1, got);
  EXPECT_TRUE(is_frame(reader.info().layout, got, 1));
  EXPECT_FALSE(is_frame(reader.info().layout, got, 2));
  got.systems[0].fields[1].back() += 0.25;
  EXPECT_FALSE(is_frame(reader.info().layout, got, 1));
}

class Recording : public RecordingTest {};

TEST_F(Recording, TheDescriptionComesBack) {
  RecordingReader reader(thread, record("a.vtkhdf", 10, 5));
  const RecordingInfo& info = reader.info();
  const RecordingLayout want = layout("", 10);
  EXPECT_EQ(info.completion, RecordingCompletion::kFinalized);
  EXPECT_EQ(info.journal, "[]");
  EXPECT_EQ(info.layout.scene_json, want.scene_json);
  EXPECT_EQ(info.layout.seed, want.seed);
  EXPECT_EQ(info.layout.dt, want.dt);
  EXPECT_EQ(info.layout.build, want.build);
  ASSERT_EQ(info.layout.parts.size(), 2u);
  for (size_t s = 0; s < 2; ++s) {
    EXPECT_EQ(info.layout.parts[s].id, want.parts[s].id);
    EXPECT_EQ(info.layout.parts[s].type, want.parts[s].type);
    EXPECT_EQ(info.layout.parts[s].max_rows, 10u);
    EXPECT_EQ(info.layout.parts[s].rows, want.parts[s].rows);
    EXPECT_EQ(info.layout.parts[s].lines, want.parts[s].lines);
    EXPECT_EQ(info.layout.parts[s].triangles, want.parts[s].triangles);
    ASSERT_EQ(info.layout.parts[s].fields.size(), want.parts[s].fields.size());
    for (size_t f = 0; f < want.parts[s].fields.size(); ++f) {
      EXPECT_EQ(info.layout.parts[s].fields[f].name, want.parts[s].fields[f].name);
      EXPECT_EQ(info.layout.parts[s].fields[f].unit, want.parts[s].fields[f].unit);
      EXPECT_EQ(info.layout.parts[s].fields[f].width, want.parts[s].fields[f].width);
      EXPECT_EQ(info.layout.parts[s].fields[f].precision, want.parts[s].fields[f].precision);
    }
  }
  ASSERT_EQ(info.layout.observables.size(), 2u);
  EXPECT_EQ(info.layout.observables[1].name, "energy.potential");
  EXPECT_EQ(info.layout.observables[1].unit, "J");
}

TEST_F(Recording, FloatsAndDoublesAreTakenFromAnyType) {
  RecordingLayout l;
  l.path = path("a.vtkhdf");
  l.parts.push_back(
      {"p",
       "particles",
       2,
       RowPolicy::kFixed,
       {{"position", "m", 3, Precision::kF64, Meaning::position}, {"mass", "kg", 1, Precision::kF32}},
       {},
       {}});
  const std::vector<float> x{1, 2, 3, 4, 5, 6};
  const std::vector<double> m{0.1, -0.0};
  {
    RecordingWriter writer(thread, l);
    const std::vector<FieldValues> fields{std::span<const float>(x), std::span<const double>(m)};
    const std::vector<PartRows> systems{{2, fields}};
    writer.append(5, 0.5, systems, {});
  }
  RecordingReader reader(thread, l.path);
  RecordedFrame got;
  reader.read(0, got);
  EXPECT_EQ(got.step, 5);
  EXPECT_EQ(got.systems[0].fields[0], (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(got.systems[0].fields[1][0], static_cast<double>(0.1f));
  EXPECT_TRUE(std::signbit(got.systems[0].fields[1][1]));
}

TEST_F(Recording, AFrameOfAnotherShapeIsRefused) {
  RecordingWriter writer(thread, layout(path("a.vtkhdf"), 4));
  Frame other;
  other.make(layout("", 5), 1);
  try {
    writer.append(0, 0, other.systems, other.observables);
    FAIL() << "a frame with too many rows was taken";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), "recording_mismatch");
  }
  append(writer, 0, 3);  // and the recording goes on
  EXPECT_EQ(writer.finalize("").state, RecordingState::kFinalized);
  EXPECT_EQ(good_frames(path("a.vtkhdf")), 3u);
}

TEST_F(Recording, LayoutsThatCannotBeRecordedNameEveryFault) {
  RecordingLayout bad = layout(path("a.vtkhdf"), 3);
  bad.parts[0].id = "a/b";
  bad.parts[0].lines = {0, 3};
  bad.parts[1].fields[1].width = 0;
  bad.observables[1].name = bad.observables[0].name;
  try {
    RecordingWriter writer(thread, bad);
    FAIL() << "a bad layout was taken";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), "recording_invalid");
    EXPECT_EQ(e.issues().size(), 4u);
  }
  EXPECT_FALSE(fs::exists(path("a.vtkhdf")));
}

TEST_F(Recording, WithoutFramesItIsStillAFile) {
  const std::string file = record("a.vtkhdf", 5, 0);
  RecordingReader reader(thread, file);
  EXPECT_EQ(reader.info().frames, 0u);
  EXPECT_EQ(reader.info().completion, RecordingCompletion::kFinalized);
}

TEST_F(Recording, TwoRecordingsShareTheThread) {
  RecordingWriter a(thread, layout(path("a.vtkhdf"), 50)), b(thread, layout(path("b.vtkhdf"), 3000));
  for (uint64_t i = 0; i < 40; ++i) {
    append(a, i, 1);
    append(b, i, 1);
  }
  a.finalize("");
  b.finalize("");
  EXPECT_EQ(good_frames(path("a.vtkhdf")), 40u);
  EXPECT_EQ(good_frames(path("b.vtkhdf")), 40u);
}

TEST_F(Recording, ASecondThreadIsRefused) {
  EXPECT_THROW(RecordingThread second, Error);
}

TEST_F(Recording, AReaderSeesDurableFramesOfALiveWriter) {
  RecordingWriter writer(thread, layout(path("a.vtkhdf"), 20000));
  append(writer, 0, 5);
  thread->run([] {});
  EXPECT_EQ(writer.durable_frames(), 5u);
  fs::copy_file(path("a.vtkhdf"), path("b.vtkhdf"));
  EXPECT_EQ(good_frames(path("b.vtkhdf")), 5u);
  EXPECT_EQ(good_frames(path("a.vtkhdf")), 5u);  // the same file, in the same process
  append(writer, 5, 3);
  EXPECT_EQ(writer.finalize("").state, RecordingState::kFinalized);
  EXPECT_EQ(good_frames(path("a.vtkhdf")), 8u);
}

}  // namespace
}  // namespace truestep::fixture
