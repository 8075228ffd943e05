// A kill tears what HDF5 rewrites in place: the blocks of its chunk index. With the chunk log beside the file
// every acknowledged frame is recovered; the control, the same file without it, loses frames.
#include "engine/sinks/recording/file/layout_bytes.h"
#include "engine/sinks/recording/log/recover.h"
#include "tests/support/patience.h"
#include "tests/unit/recording/recording_test.h"

namespace truestep::fixture {
namespace {

class TornIndex : public RecordingTest {
 protected:
  RecoveryReport recover(const std::string& file) { return recover_recording(*thread, file, {patience(5)}); }
  static std::string contents(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  // Zeros every block that begins with one of `marks`, up to the end of its page; returns their number.
  static int zero_blocks(const std::string& file, const std::vector<std::string>& marks) {
    constexpr size_t kPage = 4096;
    const std::string all = contents(file);
    std::fstream f(file, std::ios::in | std::ios::out | std::ios::binary);
    int count = 0;
    for (const std::string& mark : marks) {
      for (size_t at = all.find(mark); at != all.npos; at = all.find(mark, at + 1)) {
        if (at % 64 != 0) continue;  // the same letters in user data
        f.seekp(static_cast<std::streamoff>(at));
        f << std::string(std::min(kPage - at % kPage, all.size() - at), '\0');
        ++count;
      }
    }
    return count;
  }
  std::string copy(const std::string& file, const std::string& name, Log log) {
    fs::copy_file(file, path(name));
    if (log == Log::kept) fs::copy_file(chunk_log_path(file), chunk_log_path(path(name)));
    return path(name);
  }
};

// Extensible array: header, index block, super blocks, data blocks and their pages.
const std::vector<std::string> kIndex = {"EAHD", "EAIB", "EASB", "EADB"};

TEST_F(TornIndex, EveryAcknowledgedFrameComesBack) {
  // Many small frames in a chunk, a frame in a chunk, a frame in several chunks.
  for (const auto& [points, frames] : {std::pair{100u, 700u}, {3000u, 120u}, {60000u, 12u}}) {
    const std::string name = std::to_string(points), whole = leave("whole" + name, points, frames, Log::kept);
    const uint64_t durable = RecordingReader(thread, whole).info().frames;
    ASSERT_GT(durable, 0u);
    for (const auto& marks : {kIndex, {"EADB"}, {"EAIB"}, {"OHDR"}}) {
      const std::string file = copy(whole, name + marks[0] + std::to_string(marks.size()), Log::kept),
                        control =
                            copy(whole, name + marks[0] + std::to_string(marks.size()) + "c", Log::lost);
      const int torn = zero_blocks(file, marks);
      zero_blocks(control, marks);
      const RecoveryReport report = recover(file), without = recover(control);
      ASSERT_EQ(report.outcome, RecoveryOutcome::kRecovered) << report.message;
      EXPECT_EQ(report.frames_kept, durable) << name << ' ' << marks[0];
      EXPECT_EQ(good_frames(file), durable) << name << ' ' << marks[0];
      EXPECT_EQ(RecordingReader(thread, file).info().completion, RecordingCompletion::kFinalized);
      EXPECT_FALSE(fs::exists(chunk_log_path(file)));
      EXPECT_FALSE(fs::exists(file + ".damaged"));
      EXPECT_EQ(recover(file).outcome, RecoveryOutcome::kIntact);
      if (torn > 0) {
        EXPECT_LT(without.frames_kept, durable) << name << ' ' << marks[0];
      }
    }
  }
}

TEST_F(TornIndex, AFinishedRecordingHasNoLog) {
  const std::string file = record("a.vtkhdf", 3000, 10);
  EXPECT_FALSE(fs::exists(chunk_log_path(file)));
  EXPECT_TRUE(fs::exists(chunk_log_path(leave("b", 3000, 10, Log::kept))));  // control
}

TEST_F(TornIndex, FlippedBytesNeverPassAsFrames) {
  const std::string whole = leave("whole", 3000, 20, Log::kept);
  uint64_t shortened = 0;
  for (uint64_t k = 0; k < 24; ++k) {
    const std::string file = copy(whole, "flip" + std::to_string(k), Log::kept);
    std::fstream f(file, std::ios::in | std::ios::out | std::ios::binary);
    const auto at = static_cast<std::streamoff>((fs::file_size(whole) - 1) * k / 23);
    f.seekg(at);
    const char c = static_cast<char>(f.get() ^ 0x55);
    f.seekp(at);
    f.put(c);
    f.close();
    const RecoveryReport report = recover(file);
    shortened += report.frames_kept < 20;
    if (report.outcome != RecoveryOutcome::kRecovered) continue;  // the first frame was met
    EXPECT_EQ(good_frames(file), report.frames_kept) << k;
    EXPECT_EQ(fs::exists(file + ".damaged"), report.frames_kept < report.frames_found);
  }
  EXPECT_GT(shortened, 5u);  // most bytes belong to frames, so most flips must have been noticed
}

// A torn log names fewer frames than the file's own structures, which are used as before.
TEST_F(TornIndex, ATornLogIsNoHarm) {
  const std::string whole = leave("whole", 3000, 40, Log::kept);
  const uint64_t size = fs::file_size(chunk_log_path(whole));
  for (uint64_t part = 0; part <= 16; ++part) {
    const std::string file = copy(whole, "cut" + std::to_string(part), Log::kept);
    fs::resize_file(chunk_log_path(file), size * part / 16);
    const auto log = read_chunk_log(file);
    if (log) {
      EXPECT_LE(log->frames, 40u);
    }
    const RecoveryReport report = recover(file);
    ASSERT_EQ(report.outcome, RecoveryOutcome::kRecovered) << report.message;
    EXPECT_EQ(good_frames(file), report.frames_kept);
    EXPECT_EQ(report.frames_kept, 40u) << part;
  }
}

TEST(LayoutBytes, ComeBackAsTheyWentAndDamageIsRefused) {
  const RecordingLayout l = layout("/somewhere", 50);
  const auto bytes = layout_bytes(l);
  const auto back = layout_from_bytes(bytes);
  ASSERT_TRUE(back);
  EXPECT_EQ(layout_bytes(*back), bytes);
  EXPECT_EQ(back->parts.size(), l.parts.size());
  EXPECT_EQ(back->parts[0].fields[0].name, l.parts[0].fields[0].name);
  EXPECT_EQ(back->scene_json, l.scene_json);
  for (size_t n = 0; n < bytes.size(); ++n) {
    EXPECT_FALSE(layout_from_bytes({bytes.data(), n})) << n;
    auto flipped = bytes;
    flipped[n] ^= std::byte{0xff};
    layout_from_bytes(flipped);  // anything but a crash
  }
}

}  // namespace
}  // namespace truestep::fixture
