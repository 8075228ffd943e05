// Damaged metadata: whoever opens such a file for reading is told so, soon. The library's own number of
// attempts at a torn block of a live file waits twice as long each time and would never end.
#include <chrono>

#include "tests/unit/recording_test.h"

namespace truestep::fixture {
namespace {

TEST_F(RecordingTest, DamagedMetadataIsRefusedSoon) {
  const std::string whole = record("whole", 20, 3);
  uint64_t refused = 0;
  // The first 4 KiB hold the superblock and the headers of the first groups.
  for (uint64_t at = 0; at < 4096; at += 61) {
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
    // A millisecond for each refused block; seconds only where the machine is busy.
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5)) << "byte " << at;
  }
  EXPECT_GT(refused, 5u);  // most bytes of a header are under a checksum
}

}  // namespace
}  // namespace truestep::fixture
