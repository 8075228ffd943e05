#include "engine/sinks/recording/log/salvage.h"

#include <array>
#include <fstream>

#include "engine/base/errors.h"
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

class Superblock {
 public:
  explicit Superblock(const std::string& path) : path_(path) {
    std::ifstream(path_, std::ios::binary).read(bytes_.data(), bytes_.size());
  }
  void put_back() const {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    file.write(bytes_.data(), bytes_.size());
  }

 private:
  const std::string path_;
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
