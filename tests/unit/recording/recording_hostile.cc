// Damaged metadata: whoever opens such a file for reading gets an error soon. The library's own number of
// attempts at a torn block of a live file doubles its wait each time and would never end.
#include <chrono>

#include "engine/sinks/recording/log/recover.h"
#include "tests/support/patience.h"
#include "tests/unit/recording/recording_test.h"

namespace truestep::fixture {
namespace {

TEST_F(RecordingTest, DamagedMetadataIsRefusedSoon) {
  const std::string whole = record("whole", 20, 3);
  uint64_t refused = 0;
  // The superblock, then headers of groups and datasets, each at the start of a page.
  for (uint64_t at = 0; at < 64 * 4096; at += 4096 + 5) {
    const std::string file = path("flip");
    fs::copy_file(whole, file, fs::copy_options::overwrite_existing);
    {
      std::fstream f(file, std::ios::in | std::ios::out | std::ios::binary);
      f.seekg(static_cast<std::streamoff>(at));
      const char c = static_cast<char>(f.get() ^ 0x55);
      f.seekp(static_cast<std::streamoff>(at));
      f.put(c);
    }
    const auto start = std::chrono::steady_clock::now();
    try {
      good_frames(file);
    } catch (const Error& error) {
      ++refused;
      EXPECT_FALSE(error.code().empty());
    }
    // A millisecond for each refused block; the limit distinguishes it from an endless wait.
    EXPECT_LT(std::chrono::steady_clock::now() - start, patience(5)) << "byte " << at;
  }
  EXPECT_GT(refused, 5u);  // most bytes of a header are under a checksum
}

// A file is shortened from its end, 61 bytes at a time, so that every offset within a page occurs: each
// length is read to its last good frame or refused, and a repair of it (now and then; a repair is a process)
// recovers no more frames than from a longer file.
TEST_F(RecordingTest, TruncatedAnywhereKeepsAPrefixOrIsRefused) {
  const std::string file = record("cut", 40, 6), copy = path("copy");
  const uint64_t size = fs::file_size(file);
  uint64_t least = good_frames(file), refused = 0, repaired = 0, kept = least;
  EXPECT_EQ(least, 6u);
  for (uint64_t length = size - 1; length > 61; length -= 61) {
    fs::resize_file(file, length);
    try {
      const uint64_t frames = good_frames(file);
      EXPECT_LE(frames, least) << "a shorter file holds more, at " << length;
      least = frames;
    } catch (const Error& error) {
      ++refused;
      EXPECT_FALSE(error.code().empty());
    }
    if (length % 401 != 0) continue;
    fs::copy_file(file, copy, fs::copy_options::overwrite_existing);
    const RecoveryReport report = recover_recording(*thread, copy, {patience(5)});
    if (report.outcome != RecoveryOutcome::kRecovered) continue;
    EXPECT_EQ(good_frames(copy), report.frames_kept) << length;
    EXPECT_LE(report.frames_kept, kept) << length;
    kept = report.frames_kept;
    ++repaired;
  }
  EXPECT_GT(refused, 0u);
  EXPECT_GT(repaired, 0u) << "some cuts leave frames that a repair finds";
}

}  // namespace
}  // namespace truestep::fixture
