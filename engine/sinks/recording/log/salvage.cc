#include "engine/sinks/recording/log/salvage.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <tuple>

#include "engine/base/errors.h"
#include "engine/sinks/recording/file/plain_file.h"
#include "engine/sinks/recording/file/recorded_file.h"
#include "engine/sinks/recording/file/superblock.h"
#include "engine/sinks/recording/log/recover.h"

namespace truestep {

namespace {

// Number of frames from the first on with correct checksums.
uint64_t good_frames(const std::string& path) {
  uint64_t good = 0;
  try {
    RecordedFile file(path, RecordingOwner::kDead);
    RecordedFrame frame;
    for (; good < file.info().frames; ++good) file.read(good, frame);
  } catch (const Error&) {
  }
  return good;
}

// Kept open while the file is tried with another one.
class Superblock {
 public:
  explicit Superblock(const std::string& path) : file_(open_plainly(path, O_RDWR)) {
    known_ = ::pread(file_, bytes_.data(), bytes_.size(), 0) == static_cast<ssize_t>(bytes_.size());
  }
  ~Superblock() {
    if (file_ >= 0) ::close(file_);
  }
  Superblock(const Superblock&) = delete;
  Superblock& operator=(const Superblock&) = delete;
  void put_back() const {
    if (known_) std::ignore = ::pwrite(file_, bytes_.data(), bytes_.size(), 0);
  }

 private:
  const int file_;
  bool known_ = false;
  std::array<char, 48> bytes_{};
};

SalvageReport open_in_place(const std::string& path) {
  using Outcome = SalvageReport::Outcome;
  const uint64_t before = good_frames(path);
  const Superblock superblock(path);
  if (!repair_superblock(path)) return {Outcome::as_it_was, before};
  if (good_frames(path) >= before) return {Outcome::open, before};
  superblock.put_back();
  return {Outcome::as_it_was, before};
}

}  // namespace

SalvageReport salvage_recording(RecordingThread& thread, const std::string& path) {
  const RecoveryReport report = recover_recording(thread, path, {});
  if (report.outcome == RecoveryOutcome::kIntact || report.outcome == RecoveryOutcome::kRecovered)
    return {SalvageReport::Outcome::complete, report.frames_kept};
  SalvageReport salvaged;
  thread.run([&] { salvaged = open_in_place(path); });
  return salvaged;
}

}  // namespace truestep
