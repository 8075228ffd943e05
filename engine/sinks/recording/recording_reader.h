// Reads recordings through the process's recording thread; for `truestep info`, `export`, `diff` and tests.
#pragma once
#include <memory>

#include "engine/sinks/recording/recording_info.h"
#include "engine/sinks/recording/recording_thread.h"

namespace truestep {

class RecordingReader {
 public:
  /// Opens a finished recording, one being written, or one whose writer died. Throws Error:
  /// recording_damaged, recording_foreign, recording_io.
  RecordingReader(std::shared_ptr<RecordingThread> thread, const std::string& path);
  ~RecordingReader();
  RecordingReader(const RecordingReader&) = delete;
  RecordingReader& operator=(const RecordingReader&) = delete;

  /// The file as it was when opened; `frames` does not grow with a live writer.
  const RecordingInfo& info() const;

  /// Frame `index`, checksums verified. Throws Error: out_of_range, recording_damaged.
  void read(uint64_t index, RecordedFrame& frame);

  /// Only step, time, row counts and observables of frame `index`.
  RecordedClock read_clock(uint64_t index);

  /// One field of frame `index`: rows x width elements.
  void read_field(uint64_t index, size_t system, size_t field, std::vector<double>& out);

 private:
  struct File;
  std::shared_ptr<RecordingThread> thread_;
  std::unique_ptr<File> file_;
};

}  // namespace truestep
