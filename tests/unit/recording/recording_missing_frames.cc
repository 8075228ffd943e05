// Datasets longer than their chunks, as a disk that is full leaves them: HDF5 wrote their lengths, not their
// index. A reader shows the frames that are whole.
#include <array>

#include "engine/sinks/recording/file/h5.h"
#include "engine/sinks/recording/file/superblock.h"
#include "tests/unit/recording/recording_test.h"

namespace truestep::fixture {
namespace {

class MissingFrames : public RecordingTest {
 protected:
  using Extent = std::array<hsize_t, 3>;

  /// Changes a dataset's extent to what `less` makes of it and back: HDF5 drops the chunks in between.
  template <class Less>
  Extent drop(const std::string& file, const std::string& dataset, const Less& less) {
    Extent whole{0, 1, 1};
    EXPECT_TRUE(repair_superblock(file));  // its writer is still marked as alive
    thread->run([&] {
      const H5 f = h5_id(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "open the recording");
      const H5 set = h5_id(H5Dopen2(f, dataset.c_str(), H5P_DEFAULT), "open a dataset");
      const H5 space = h5_id(H5Dget_space(set), "read a shape");
      h5_ok(H5Sget_simple_extent_dims(space, whole.data(), nullptr), "read a shape");
      Extent left = whole;
      less(left);
      h5_ok(H5Dset_extent(set, left.data()), "shorten a dataset");
      h5_ok(H5Dset_extent(set, whole.data()), "lengthen a dataset");
    });
    return whole;
  }
  uint64_t frames(const std::string& file) { return RecordingReader(thread, file).info().frames; }
};

TEST_F(MissingFrames, AreLeftOutWhicheverDatasetLacksThem) {
  constexpr uint64_t kFrames = 30, kKept = 17;
  const std::string whole = leave("whole", 3000, kFrames);  // a frame fills a chunk
  ASSERT_EQ(frames(whole), kFrames);                        // control
  size_t k = 0;
  for (const char* dataset :
       {"/clock/step", "/clock/time", "/observables/energy.kinetic/value",
        "/observables/energy.potential/value", "/particles/cloth/position/value",
        "/particles/cloth/velocity/value", "/particles/sparks/rows", "/particles/sparks/position/value",
        "/particles/sparks/age/value", "/particles/sparks/id/value"}) {
    const std::string file = path("short" + std::to_string(k++));
    fs::copy_file(whole, file);
    const Extent claimed = drop(file, dataset, [](Extent& e) { e[0] = kKept; });
    EXPECT_EQ(claimed[0], kFrames) << dataset;  // what made them visible as damaged frames
    EXPECT_EQ(frames(file), kKept) << dataset;
    EXPECT_EQ(good_frames(file), kKept) << dataset;
  }
}

TEST_F(MissingFrames, TakeTheOthersOfTheirChunkWithThem) {
  const std::string file = leave("small", 20, 3 * 64);  // 64 frames share a chunk
  ASSERT_EQ(frames(file), 3 * 64u);
  drop(file, "/particles/cloth/velocity/value", [](Extent& e) { e[0] = 2 * 64; });
  EXPECT_EQ(frames(file), 2 * 64u);
  EXPECT_EQ(good_frames(file), 2 * 64u);
}

TEST_F(MissingFrames, LeaveNoneWhenNothingIsThere) {
  const std::string file = leave("none", 3000, 5);
  drop(file, "/particles/sparks/age/value", [](Extent& e) { e[0] = 0; });
  EXPECT_EQ(frames(file), 0u);
}

/// Four frames a chunk and room for eight times the usual rows, in chunks of the usual number.
class MissingRows : public MissingFrames {
 protected:
  static constexpr uint32_t kUsual = 2000, kMost = 16000;

  // A killed recorder's file with these numbers of rows.
  std::string grown(const std::string& name, const std::vector<size_t>& rows) {
    RecordingLayout l = layout(path(name + ".alive"), kMost, Systems::kVariable);
    l.parts[0].usual_rows = kUsual;
    RecordingWriter writer(thread, l);
    const std::vector<double> zeros(size_t{3} * kMost);
    for (size_t i = 0; i < rows.size(); ++i) {
      const std::span<const double> all(zeros);
      const std::vector<FieldValues> values{all.first(3 * rows[i]), all.first(rows[i]), all.first(rows[i])};
      writer.append(static_cast<int64_t>(i), 0.01 * static_cast<double>(i),
                    std::vector<PartRows>{{rows[i], values}}, std::array<double, 2>{1, 2});
    }
    thread->run([] {});
    EXPECT_EQ(writer.durable_frames(), rows.size() / writer.frames_per_chunk() * writer.frames_per_chunk());
    fs::copy_file(path(name + ".alive"), path(name));
    return path(name);
  }
  static void one_column(Extent& e) { e[1] = kUsual; }
};

// What a part does not use at the time is not missing.
TEST_F(MissingRows, AreThoseThatAFrameHas) {
  std::vector<size_t> rows(24, kUsual);
  rows[10] = kMost;  // grown in the middle, usual again at the end
  EXPECT_EQ(frames(grown("fallen", rows)), rows.size());
  rows[rows.size() - 1] = kUsual + 1;  // the last frame needs a second column
  const std::string file = grown("grown", rows);
  EXPECT_EQ(frames(file), rows.size());
  drop(file, "/particles/sparks/age/value", one_column);
  const uint64_t left = frames(file);
  EXPECT_LT(left, rows.size());
  EXPECT_GT(left, 11u) << "only what is at the end is looked at";
  RecordingReader reader(thread, file);
  RecordedFrame frame;
  reader.read(left - 1, frame);
  EXPECT_EQ(frame.systems[0].rows, kUsual);
}

}  // namespace
}  // namespace truestep::fixture
