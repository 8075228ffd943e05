// A session's recording: takes the fields of every n-th step and passes them to the writer, which makes the
// session wait rather than leave a gap. The recording ends at the scene's duration, when the clock goes back,
// or when it is told to.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "engine/session/session.h"
#include "engine/sinks/recording/recording_layout.h"
#include "engine/sinks/recording/recording_writer.h"

namespace truestep {

/// How a recording begins, and who is told of its end.
struct RecordingTies {
  /// Continues an earlier file whose last frame was of this step: the next frame is the first one missing
  /// there.
  std::optional<uint64_t> after;
  /// What is recorded, until it is told to end; empty: what the scene asks for, as long as the scene lasts.
  std::optional<RecordingParams> asked;
  /// Called once, by `finish`.
  std::function<void(const RecordingStatus&)> finished;
};

class RecordingSink : public Sink {
 public:
  /// Records what the ties, or the scene's `recording` (or its default), ask for: recording_layout.h. Creates
  /// the file and, unless it continues another, records the session's present state.
  RecordingSink(std::shared_ptr<RecordingThread> thread, const Session& session, const std::string& path,
                RecordingTies ties = {});

  bool due(uint64_t step) override;
  const FrameRequest& request() const override { return request_; }
  void accept(const FramePtr& frame) override;
  void notify(std::string_view kind, uint64_t step, const std::string& detail) override;

  /// Completes the file: journal, VTKHDF part. It can be downloaded afterwards; a second call does nothing.
  RecordingStatus finish();
  /// The same without telling anybody: the session continues elsewhere, and its recording with it.
  RecordingStatus close();
  /// The last step whose frame survives the process; empty before the first.
  std::optional<uint64_t> durable_step() const;
  /// Whether a frame of a later step than `step` belongs to the recording.
  static bool goes_on(const World& world, uint64_t step);
  RecordingStatus status() const { return writer_.status(); }
  bool failed() const { return writer_.failed(); }
  const std::string& path() const { return writer_.layout().path; }

 private:
  RecordingSink(std::shared_ptr<RecordingThread> thread, const Session& session, PlannedRecording plan,
                RecordingTies ties);
  /// Rows of the recorded part `i`; the values are borrowed from the frame or stored in gathered_.
  size_t rows_of(const Frame& frame, size_t i, std::vector<FieldValues>& values);
  size_t obstacles_of(const Frame& frame, size_t i, std::vector<FieldValues>& values);

  const Session& session_;
  RecordingTies ties_;
  uint64_t every_, first_step_, last_step_;
  bool finished_ = false;
  std::vector<RecordedSource> sources_;
  RecordingWriter writer_;
  FrameRequest request_;
  /// Rows on their way to the writer; empty for fields whose rows are passed as they are.
  std::vector<std::vector<std::vector<double>>> gathered_;
  std::shared_ptr<const Drawing> first_look_, last_look_;
  std::vector<DrawnShape> first_obstacles_;
};

}  // namespace truestep
