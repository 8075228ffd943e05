// Records one session: the producer lays rows out as finished chunks, the recording thread stores them.
// append() waits when the thread is behind (its queue is bounded in bytes) and never drops a frame.
// An HDF5 error ends this recording only: the state becomes failed with a code and a sentence, frames that
// were durable stay readable, later frames are ignored.
#pragma once
#include <memory>

#include "engine/sinks/recording/file/layout.h"
#include "engine/sinks/recording/recording_thread.h"

namespace truestep {

enum class RecordingState { kRecording, kFinalized, kFailed };

struct RecordingStatus {
  RecordingState state = RecordingState::kRecording;
  uint64_t appended_frames = 0;
  uint64_t durable_frames = 0;  ///< readable even if the process dies now
  std::string code;             ///< disk_full, recording_io; empty unless failed
  std::string message;
};

class RecordingWriter {
 public:
  /// When the file is created; a recording without frames then leaves none, and errors appear in the status.
  enum class File : uint8_t { at_once, with_first_frames };
  /// Creates the file. Throws Error("recording_invalid") for a layout that cannot be recorded, or the HDF5
  /// error.
  RecordingWriter(std::shared_ptr<RecordingThread> thread, RecordingLayout layout, File file = File::at_once);
  ~RecordingWriter();  ///< finalises with an empty journal if that has not been done
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// Takes one frame; the data is copied before it returns. Throws Error("recording_mismatch") when shapes
  /// differ from the layout; ignored unless recording. Small frames become durable in groups of
  /// `frames_per_chunk()`.
  void append(int64_t step, double time, std::span<const PartRows> systems,
              std::span<const double> observables);

  /// Writes the remaining frames, the journal and the VTKHDF part, closes the file and waits for it; a second
  /// call does nothing.
  /// If given, `drawing` replaces the initial shapes.
  RecordingStatus finalize(const std::string& journal, const RecordedDrawing* drawing = nullptr);

  RecordingStatus status() const;
  /// Whether it has failed, without the words.
  bool failed() const;
  uint64_t durable_frames() const;
  size_t frames_per_chunk() const;
  const RecordingLayout& layout() const;

 private:
  struct Core;
  struct Batch;
  void submit();

  std::shared_ptr<Core> core_;
  std::unique_ptr<Batch> batch_;  // being filled
};

}  // namespace truestep
