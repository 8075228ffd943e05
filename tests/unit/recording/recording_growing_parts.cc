// Parts whose rows grow: room for spawned bodies and emitters takes no space in the file until it is used.
#include <array>

#include "engine/sinks/recording/log/recover.h"
#include "tests/unit/recording/recording_test.h"

namespace truestep::fixture {
namespace {

constexpr uint32_t kMost = 10145, kUsual = 145;

RecordingLayout growing(const std::string& path) {
  RecordingLayout l = layout(path, 3, Systems::kVariable);
  l.parts[0].max_rows = kMost;
  l.parts[0].usual_rows = kUsual;
  return l;
}

/// Rows and numbers of a frame that follow from its index.
struct GrowingFrame {
  explicit GrowingFrame(uint64_t frame, size_t count) : rows(count) {
    for (size_t f = 0; f < 3; ++f) {
      const size_t width = f == 0 ? 3 : 1;
      for (size_t i = 0; i < rows * width; ++i) data[f].push_back(value(frame, 0, f, i));
      values.emplace_back(std::span<const double>(data[f]));
    }
  }
  size_t rows;
  std::array<std::vector<double>, 3> data;
  std::vector<FieldValues> values;
};

class RecordingOfGrowingParts : public RecordingTest {
 protected:
  void append(RecordingWriter& writer, uint64_t frame, size_t rows) {
    const GrowingFrame f(frame, rows);
    const std::vector<PartRows> parts{{f.rows, f.values}};
    writer.append(static_cast<int64_t>(frame), 0.01 * static_cast<double>(frame), parts,
                  std::array<double, 2>{1, 2});
  }
  void check(const std::string& file, const std::vector<size_t>& rows) {
    RecordingReader reader(thread, file);
    ASSERT_EQ(reader.info().frames, rows.size());
    RecordedFrame got;
    for (uint64_t i = 0; i < rows.size(); ++i) {
      reader.read(i, got);
      const GrowingFrame want(i, rows[i]);
      ASSERT_EQ(got.systems[0].rows, rows[i]) << "frame " << i;
      // Positions are f64 and ages f32, in which quarters are exact; ids are whole numbers and are left out.
      EXPECT_EQ(got.systems[0].fields[0], want.data[0]) << "frame " << i;
      EXPECT_EQ(got.systems[0].fields[1], want.data[1]) << "frame " << i;
    }
  }
};

// Constant, growing in the middle of a chunk of frames, falling again, and at the most.
std::vector<size_t> rows_over_time() {
  std::vector<size_t> rows(100, kUsual);
  for (size_t i = 40; i < 60; ++i) rows[i] = kUsual + 23 * (i - 39);
  rows[70] = 0, rows[71] = kMost;
  return rows;
}

TEST_F(RecordingOfGrowingParts, EveryNumberComesBack) {
  const auto rows = rows_over_time();
  {
    RecordingWriter writer(thread, growing(path("a.vtkhdf")));
    for (uint64_t i = 0; i < rows.size(); ++i) append(writer, i, rows[i]);
  }
  check(path("a.vtkhdf"), rows);
}

TEST_F(RecordingOfGrowingParts, TheFileHasTheRowsThatThereWere) {
  const auto record = [&](const RecordingLayout& l) {
    {
      RecordingWriter writer(thread, l);
      for (uint64_t i = 0; i < 64; ++i) append(writer, i, kUsual);
    }
    RecordingReader reader(thread, l.path);
    return reader.info().layout.parts[0].max_rows;
  };
  RecordingLayout whole_room = growing(path("control.vtkhdf"));
  whole_room.parts[0].usual_rows = 0;
  EXPECT_EQ(record(growing(path("a.vtkhdf"))), kUsual);
  EXPECT_EQ(record(whole_room), kMost);
  // 64 frames of 32 bytes a row are 0.3 MB of bodies or 20.8 MB of room; both have the file's own structures,
  // too.
  EXPECT_LT(10 * fs::file_size(path("a.vtkhdf")), fs::file_size(whole_room.path));
}

TEST_F(RecordingOfGrowingParts, AKilledRecorderLosesNoRow) {
  const auto rows = rows_over_time();
  RecordingWriter writer(thread, growing(path("alive.vtkhdf")));
  for (uint64_t i = 0; i < rows.size(); ++i) append(writer, i, rows[i]);
  thread->run([] {});
  const uint64_t durable = writer.durable_frames();
  ASSERT_GT(durable, 60u);
  fs::copy_file(path("alive.vtkhdf"), path("a.vtkhdf"));
  const std::vector<size_t> kept(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(durable));
  check(path("a.vtkhdf"), kept);
  fs::copy_file(chunk_log_path(path("alive.vtkhdf")), chunk_log_path(path("a.vtkhdf")));
  EXPECT_EQ(recover_recording(*thread, path("a.vtkhdf"), {}).frames_kept, durable);
  check(path("a.vtkhdf"), kept);
}

}  // namespace
}  // namespace truestep::fixture
