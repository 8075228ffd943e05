// The contents of a session's recording.
#pragma once
#include <optional>

#include "engine/session/world/world.h"
#include "engine/sinks/recording/file/layout.h"

namespace truestep {

/// Where a recorded part's rows come from. Without a part, they are the obstacles of the drawing.
struct RecordedSource {
  std::optional<size_t> part;
  std::vector<size_t> fields;  ///< of the part, in the layout's order
  size_t stride = 1;           ///< one in this many rows is recorded: those between are its trail
};

struct PlannedRecording {
  RecordingLayout layout;
  std::vector<RecordedSource> sources;  ///< in the layout's order
};

/// What `asked` asks for, as a scene's `recording` does. By default, whatever drawing needs (positions,
/// orientations, shapes, the values that colour them, which rows sleep), all of a grid, and the states of
/// purely numerical systems; energies and probes always. Error "scene_invalid" with the pointer of a field
/// that no system has or that cannot be recorded.
PlannedRecording plan_recording(const World& world, const std::string& path, const RecordingParams& asked);

/// The shapes of a drawing in the order of `sources`.
RecordedDrawing recorded_drawing(const std::vector<RecordedSource>& sources, const Drawing& constant,
                                 std::span<const DrawnShape> obstacles);

}  // namespace truestep
