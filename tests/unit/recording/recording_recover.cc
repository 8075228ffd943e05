#include "engine/sinks/recording/log/recover.h"

#include "engine/sinks/recording/file/superblock.h"
#include "tests/support/patience.h"
#include "tests/unit/recording/recording_test.h"

namespace truestep::fixture {
namespace {

class RecordingRecovery : public RecordingTest {
 protected:
  RecoveryReport recover(const std::string& file) { return recover_recording(*thread, file, {patience(5)}); }
  void flip(const std::string& file, uint64_t at) {
    std::fstream f(file, std::ios::in | std::ios::out | std::ios::binary);
    f.seekg(static_cast<std::streamoff>(at));
    const char c = static_cast<char>(f.get() ^ 0x55);
    f.seekp(static_cast<std::streamoff>(at));
    f.put(c);
  }
  // Files in the folder besides the given one: leftovers of a repair.
  std::vector<std::string> others(const std::string& file) {
    std::vector<std::string> names;
    for (const auto& e : fs::directory_iterator(folder)) {
      const std::string p = e.path().string();
      if (p.rfind(file, 0) == 0 && p != file) names.push_back(e.path().filename());
    }
    return names;
  }
};

TEST_F(RecordingRecovery, AnUnfinishedFileIsFinalized) {
  for (uint32_t points : {100u, 20000u}) {
    const std::string file = leave("a" + std::to_string(points), points, 70);
    const uint64_t durable =
        points == 100 ? 38 : 70;  // small frames become durable in whole chunks of 256 KiB
    {
      RecordingReader reader(thread, file);
      EXPECT_EQ(reader.info().completion, RecordingCompletion::kUnfinished);
      EXPECT_EQ(reader.info().frames, durable);
    }
    const RecoveryReport report = recover(file);
    EXPECT_EQ(report.outcome, RecoveryOutcome::kRecovered) << report.message;
    EXPECT_EQ(report.frames_kept, durable);
    EXPECT_EQ(good_frames(file), durable);
    EXPECT_EQ(RecordingReader(thread, file).info().completion, RecordingCompletion::kFinalized);
    EXPECT_TRUE(others(file).empty() || others(file)[0].find(".alive") != std::string::npos);
    EXPECT_EQ(recover(file).outcome, RecoveryOutcome::kIntact);
  }
}

TEST_F(RecordingRecovery, ATruncatedFileKeepsItsPrefix) {
  const std::string whole = leave("whole", 3000, 40);
  const uint64_t size = fs::file_size(whole);
  uint64_t most = 0;
  for (uint64_t part = 1; part <= 24; ++part) {
    const std::string file = path("cut" + std::to_string(part));
    fs::copy_file(whole, file);
    fs::resize_file(file, size * part / 24);
    const RecoveryReport report = recover(file);
    if (report.outcome == RecoveryOutcome::kRecovered) {
      EXPECT_EQ(good_frames(file), report.frames_kept) << part;
      EXPECT_GE(report.frames_kept, most) << part;  // a longer file never retains less
      most = report.frames_kept;
      EXPECT_EQ(fs::exists(file + ".damaged"), report.frames_kept < report.frames_found);
    } else {
      EXPECT_EQ(fs::file_size(file), size * part / 24) << "an unreadable file stays as it was";
    }
    EXPECT_FALSE(fs::exists(file + ".recovering"));
    EXPECT_FALSE(fs::exists(file + ".repair"));
  }
  EXPECT_EQ(most, 40u);
}

TEST_F(RecordingRecovery, AFinishedFileThatLostItsTailKeepsItsPrefix) {
  const std::string file = record("a.vtkhdf", 3000, 40);
  fs::resize_file(file, fs::file_size(file) / 2);
  const RecoveryReport report = recover(file);
  if (report.outcome == RecoveryOutcome::kRecovered) {
    EXPECT_EQ(good_frames(file), report.frames_kept);
    EXPECT_GT(report.frames_kept, 0u);
  }
  EXPECT_EQ(report.outcome, RecoveryOutcome::kRecovered) << report.message;
}

TEST_F(RecordingRecovery, FlippedBytesNeverPassAsFrames) {
  const std::string whole = leave("whole", 3000, 20);
  const uint64_t size = fs::file_size(whole);
  uint64_t shortened = 0;
  for (uint64_t k = 0; k < 32; ++k) {
    const std::string file = path("flip" + std::to_string(k));
    fs::copy_file(whole, file);
    flip(file, (size - 1) * k / 31);
    const RecoveryReport report = recover(file);
    if (report.outcome != RecoveryOutcome::kRecovered) continue;
    EXPECT_EQ(good_frames(file), report.frames_kept) << k;
    if (report.frames_kept < 20) ++shortened;
  }
  EXPECT_GT(shortened, 10u);  // most bytes belong to frames, so most flips must have been noticed
}

TEST_F(RecordingRecovery, TheTimeLimitEndsTheChild) {
  const std::string file = leave("a", 20000, 40);
  const RecoveryReport report = recover_recording(*thread, file, {std::chrono::milliseconds(0)});
  EXPECT_EQ(report.outcome, RecoveryOutcome::kTimedOut);
  EXPECT_EQ(good_frames(file), 40u);
  EXPECT_FALSE(fs::exists(file + ".recovering"));
}

TEST_F(RecordingRecovery, WhatIsNoRecordingStaysAsItIs) {
  std::ofstream(path("text.vtkhdf")) << std::string(5000, 'x');
  EXPECT_EQ(recover(path("text.vtkhdf")).outcome, RecoveryOutcome::kUnreadable);
  EXPECT_EQ(fs::file_size(path("text.vtkhdf")), 5000u);
  EXPECT_EQ(recover(path("missing.vtkhdf")).outcome, RecoveryOutcome::kUnreadable);
}

// Values published with the hash: lookup3.c prints them from its driver5.
TEST(Lookup3, AgreesWithPublishedValues) {
  EXPECT_EQ(lookup3("", 0), 0xdeadbeefu);
  EXPECT_EQ(lookup3("Four score and seven years ago", 30), 0x17770551u);
  EXPECT_NE(lookup3("Four score and seven years agO", 30), 0x17770551u);
}

}  // namespace
}  // namespace truestep::fixture
