// A recording's frames in the form that a session provides, so that they are drawn the same way. The world
// comes from the recorded scene; nothing is simulated. Trails are assembled from earlier frames, obstacles
// come from their own part. Anything not in the recording (contacts, joints, unrecorded fields) is not in its
// frames.
#pragma once
#include <map>
#include <memory>
#include <optional>

#include "engine/session/world/frame.h"
#include "engine/session/world/world.h"
#include "engine/sinks/recording/recording_reader.h"

namespace truestep {

class RecordedFrames {
 public:
  /// Error "recording_foreign" when the recording has no frames, or its scene lacks its parts. `reader` must
  /// outlive this.
  explicit RecordedFrames(RecordingReader& reader);

  const World& world() const { return *world_; }
  uint64_t count() const { return reader_.info().frames; }
  double time(uint64_t index) const { return reader_.read_clock(index).time; }
  FramePtr frame(uint64_t index);

 private:
  void add_obstacles(uint64_t index, size_t part, Frame& out);
  FrameBlock block(uint64_t index, size_t part, size_t field);
  const std::vector<double>& trail_values(uint64_t index, size_t part, size_t field);

  RecordingReader& reader_;
  std::unique_ptr<const World> world_;
  std::vector<std::optional<size_t>> parts_;  ///< per recorded part: index in the world; empty: the obstacles
  std::shared_ptr<const Drawing> constant_;
  std::vector<DrawnShape> obstacles_;
  uint64_t every_ = 1;                                                  ///< steps between frames
  std::map<std::pair<size_t, uint64_t>, std::vector<double>> earlier_;  ///< for trails: by part and frame
};

}  // namespace truestep
