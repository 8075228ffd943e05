#include <sys/resource.h>

#include <csignal>

#include "engine/sinks/recording/file/fletcher32.h"
#include "engine/sinks/recording/log/recover.h"
#include "tests/unit/recording/recording_test.h"

namespace truestep::fixture {
namespace {

// Limits the growth of files to `bytes`: a full disk as seen by one process.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) {
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileLimit() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }

 private:
  rlimit old_{};
  void (*old_handler_)(int) = nullptr;
};

class RecordingFailure : public RecordingTest {};

TEST_F(RecordingFailure, AFullDiskEndsTheRecordingOnly) {
  uint64_t durable = 0;
  {
    FileLimit limit(size_t{4} << 20);
    RecordingWriter writer(thread, layout(path("a.vtkhdf"), 5000));
    for (uint64_t i = 0; i < 100 && writer.status().state == RecordingState::kRecording; ++i)
      append(writer, i, 1);
    const RecordingStatus status = writer.finalize("");
    EXPECT_EQ(status.state, RecordingState::kFailed);
    EXPECT_EQ(status.code, "disk_full");
    EXPECT_NE(status.message.find("disk is full"), std::string::npos);
    durable = status.durable_frames;
    append(writer, 100, 1);  // ignored
  }
  EXPECT_GT(durable, 0u);
  // Under this limit the library cannot even extend the file to its recorded end, which a full disk allows.
  recover_recording(*thread, path("a.vtkhdf"), {});
  EXPECT_GE(good_frames(path("a.vtkhdf")), durable);
  EXPECT_EQ(good_frames(record("b.vtkhdf", 5000, 20)), 20u);  // the thread serves the next one
}

TEST_F(RecordingFailure, WithoutALimitTheSameFramesAreRecorded) {  // control
  EXPECT_EQ(good_frames(record("a.vtkhdf", 5000, 100)), 100u);
}

TEST_F(RecordingFailure, AFolderThatIsMissingIsReported) {
  try {
    RecordingWriter writer(thread, layout(path("no/such/a.vtkhdf"), 5));
    FAIL() << "created a file in a missing folder";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), "recording_io");
  }
}

TEST_F(RecordingFailure, OtherFilesAreRefused) {
  std::ofstream(path("text.vtkhdf")) << "not a recording";
  EXPECT_THROW(RecordingReader(thread, path("text.vtkhdf")), Error);
  EXPECT_THROW(RecordingReader(thread, path("missing.vtkhdf")), Error);
}

// Word by word as the definition says.
uint32_t fletcher32_plain(const std::vector<unsigned char>& data) {
  uint64_t s1 = 0, s2 = 0;
  for (size_t i = 0; i < data.size(); i += 2) {
    s1 += (data[i] << 8) + (i + 1 < data.size() ? data[i + 1] : 0);
    while (s1 > 65535) s1 = (s1 & 0xffff) + (s1 >> 16);
    s2 += s1;
    while (s2 > 65535) s2 = (s2 & 0xffff) + (s2 >> 16);
  }
  return static_cast<uint32_t>(s2 << 16 | s1);
}

TEST(Fletcher32, AgreesWithTheDefinition) {
  std::vector<unsigned char> data;
  uint32_t x = 12345;
  for (size_t size : {0, 1, 2, 3, 31, 32, 33, 64, 1000, 11519, 11520, 11521, 23041, 100000}) {
    for (unsigned fill : {0u, 255u, 7u}) {  // zeros and ones reach both ends of the reduction
      data.assign(size, static_cast<unsigned char>(fill));
      if (fill == 7) {
        for (unsigned char& c : data) c = static_cast<unsigned char>((x = x * 1664525 + 1013904223) >> 24);
      }
      EXPECT_EQ(fletcher32(data.data(), size), fletcher32_plain(data)) << size << " bytes of " << fill;
      if (size > 0) {  // control: one bit changes the sum
        const uint32_t before = fletcher32(data.data(), size);
        data[size / 2] ^= 1;
        EXPECT_NE(fletcher32(data.data(), size), before) << size << " bytes of " << fill;
      }
    }
  }
}

}  // namespace
}  // namespace truestep::fixture
